#include "io/picture_file.h"

#include <string>
#include <utility>

#include "host/atomic_file.h"

namespace chladni::io {

struct PaintQueue::Place {
  explicit Place(Places& places) : places_(places) { places_.acquire(); }
  ~Place() { places_.release(); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  Places& places_;
};

void PaintQueue::add(std::filesystem::path png, Picture picture) {
  auto done = std::async(std::launch::async, [this, png, picture = std::move(picture)] {
    const Place place(places_);
    write_atomically(png, picture());
  });
  jobs_.push_back({std::move(png), std::move(done)});
}

std::vector<PaintQueue::Painted> PaintQueue::finish() {
  std::vector<Painted> all;
  for (auto& job : std::exchange(jobs_, {})) {
    Painted painted{job.png, nullptr};
    try {
      job.done.get();
    } catch (...) {
      painted.failure = std::current_exception();
    }
    all.push_back(std::move(painted));
  }
  return all;
}

PictureFile::PictureFile(std::filesystem::path png, PaintQueue* queue, bool vectors)
    : png_(std::move(png)), queue_(queue), vectors_(vectors) {}

PictureFile::PictureFile(std::filesystem::path png, PaintQueue* queue, const Print& print)
    : png_(std::move(png)), queue_(queue), vectors_(print.svg), print_(print) {}

double PictureFile::layout_width(double usual) const {
  constexpr double kPixelsPerPoint = 2.0, kPointsPerMm = 72.0 / 25.4;
  return print_ ? kPixelsPerPoint * kPointsPerMm * print_->width_mm : usual;
}

void PictureFile::leave_vectors(const std::function<std::string()>& svg) const {
  if (png_.empty() || !vectors_) return;
  write_atomically(std::filesystem::path(png_).replace_extension(".svg"), svg());
}

void PictureFile::paint(Picture picture) const {
  if (png_.empty()) return;
  if (queue_ != nullptr) {
    queue_->add(png_, std::move(picture));
  } else {
    write_atomically(png_, picture());
  }
}

}  // namespace chladni::io
