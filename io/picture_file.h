// Where a picture goes, and whether the program waits until it is painted.
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <semaphore>
#include <vector>

namespace chladni::io {

/// Gives the bytes of a PNG.
using Picture = std::function<std::string()>;

/// Paints pictures while the program goes on, two at a time. The destructor waits for them.
class PaintQueue {
 public:
  struct Painted {
    std::filesystem::path png;
    std::exception_ptr failure;  ///< null if the file is there
  };

  void add(std::filesystem::path png, Picture picture);
  /// Waits for all pictures, and tells each once, in the order of add().
  [[nodiscard]] std::vector<Painted> finish();

 private:
  // Half of a painter's time is the start of its display, which does not fill a core.
  static constexpr int kAtOnce = 2;
  using Places = std::counting_semaphore<kAtOnce>;
  struct Place;

  struct Job {
    std::filesystem::path png;
    std::future<void> done;
  };
  Places places_{kAtOnce};
  std::vector<Job> jobs_;
};

/// The largest pictures that the painter makes, along a side and in all [px]. It draws twice as
/// fine and needs some 190 bytes for each pixel: 4 GB in all.
inline constexpr double kLongestPicture = 8192.0, kMostPixels = 20e6;

/// How plots are printed on paper: without a title, which belongs into the caption.
struct Print {
  double width_mm = 160.0;
  double dpi = 300.0;  ///< of the PNG [1/inch]
  bool svg = true, png = true;
};

/// A file for one picture. Without a queue the picture is there when it was drawn, with one when
/// the queue has finished.
class PictureFile {
 public:
  /// @param png      empty: nothing is left, and what cannot be drawn is refused as ever
  /// @param vectors  what can be drawn by lines is also left as an SVG of that name
  PictureFile(std::filesystem::path png, PaintQueue* queue = nullptr, bool vectors = false);

  /// For paper: what can be drawn by lines is laid out for the width of `print`, so that its words
  /// have 7 to 8 pt, and is left as an SVG, a PNG or both. Pictures of a body stay as they are.
  PictureFile(std::filesystem::path png, PaintQueue* queue, const Print& print);

  /// None: for the screen.
  [[nodiscard]] const std::optional<Print>& print() const { return print_; }
  /// Width of the layout [px]: `usual` on the screen, two pixels for each point on paper.
  [[nodiscard]] double layout_width(double usual) const;

  /// @throws what `picture` throws, if there is no queue
  void paint(Picture picture) const;
  /// Writes the SVG beside the PNG, if that was asked for.
  void leave_vectors(const std::function<std::string()>& svg) const;

 private:
  std::filesystem::path png_;
  PaintQueue* queue_;
  bool vectors_;
  std::optional<Print> print_;
};

}  // namespace chladni::io
