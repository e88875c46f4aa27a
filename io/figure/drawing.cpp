#include "io/figure/drawing.h"

namespace chladni::io {
namespace {

Json colour_json(const Colour& colour) { return JsonArray{colour[0], colour[1], colour[2]}; }

}  // namespace

void Drawing::add(const char* kind, const std::vector<Path>& paths, const Colour& colour,
                  double width) {
  if (paths.empty()) return;
  shapes_.emplace_back(JsonObject{{"kind", kind},
                                  {"colour", colour_json(colour)},
                                  {"width", width},
                                  {"paths", static_cast<long>(paths.size())}});
  for (const auto& path : paths) {
    counts_.push_back(static_cast<std::int32_t>(path.size()));
    points_.insert(points_.end(), path.begin(), path.end());
  }
}

void Drawing::lines(const std::vector<Path>& paths, const Colour& colour, double width) {
  add("lines", paths, colour, width);
}

void Drawing::polygons(const std::vector<Path>& paths, const Colour& colour) {
  add("polygons", paths, colour, 0.0);
}

void Drawing::text(const Eigen::Vector2d& at, const std::string& words, double size,
                   const Colour& colour, Align align, bool bold, bool upwards) {
  if (words.empty()) return;
  constexpr const char* aligns[] = {"left", "centre", "right"};
  texts_.emplace_back(JsonObject{{"x", at.x()},
                                 {"y", at.y()},
                                 {"words", words},
                                 {"size", size},
                                 {"colour", colour_json(colour)},
                                 {"align", aligns[static_cast<int>(align)]},
                                 {"bold", bold ? 1 : 0},
                                 {"upwards", upwards ? 1 : 0}});
}

Message Drawing::request() const {
  Message request;
  auto& points = request.doubles["points"];
  points.resize(static_cast<Eigen::Index>(points_.size()), 2);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    points.row(static_cast<Eigen::Index>(p)) = points_[p].transpose();
  }
  auto& counts = request.integers["counts"];
  counts.resize(static_cast<Eigen::Index>(counts_.size()), 1);
  for (std::size_t c = 0; c < counts_.size(); ++c)
    counts(static_cast<Eigen::Index>(c)) = counts_[c];
  request.head = JsonObject{{"kind", "drawing"},
                            {"width", width_},
                            {"height", height_},
                            {"shapes", shapes_},
                            {"texts", texts_}};
  return request;
}

double text_width(const std::string& words, double size) {
  double letters = 0.0;
  for (const char c : words) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
    const bool narrow = std::string_view(" .,:;'|!iljtf()[]/-").find(c) != std::string_view::npos;
    if (!continues) letters += narrow ? 0.32 : c >= 'A' && c <= 'Z' ? 0.68 : 0.56;
  }
  return letters * size;
}

}  // namespace chladni::io
