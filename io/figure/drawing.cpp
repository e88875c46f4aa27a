#include "io/figure/drawing.h"

#include <cmath>

namespace chladni::io {
namespace {

Json colour_json(const Colour& colour) { return JsonArray{colour[0], colour[1], colour[2]}; }

}  // namespace

void Drawing::lines(const std::vector<Path>& paths, const Colour& colour, double width) {
  if (!paths.empty()) shapes_.push_back({false, colour, width, paths});
}

void Drawing::polygons(const std::vector<Path>& paths, const Colour& colour) {
  if (!paths.empty()) shapes_.push_back({true, colour, 0.0, paths});
}

void Drawing::text(const Eigen::Vector2d& at, const std::string& words, double size,
                   const Colour& colour, Align align, bool bold, bool upwards) {
  if (!words.empty()) texts_.push_back({at, words, size, colour, align, bold, upwards});
}

// What is whole but for rounding gets no further column.
Eigen::Vector2d Drawing::pixels(double finer) const {
  constexpr double kRounding = 1e-6;
  return {std::ceil(finer * width_ - kRounding), std::ceil(finer * height_ - kRounding)};
}

Message Drawing::request(double finer) const {
  Message request;
  JsonArray shapes;
  std::vector<Eigen::Vector2d> places;
  std::vector<std::int32_t> sizes;
  for (const auto& shape : shapes_) {
    shapes.emplace_back(JsonObject{{"kind", shape.filled ? "polygons" : "lines"},
                                   {"colour", colour_json(shape.colour)},
                                   {"width", finer * shape.width},
                                   {"paths", static_cast<long>(shape.paths.size())}});
    for (const auto& path : shape.paths) {
      sizes.push_back(static_cast<std::int32_t>(path.size()));
      places.insert(places.end(), path.begin(), path.end());
    }
  }
  auto& points = request.doubles["points"];
  points.resize(std::ssize(places), 2);
  for (std::size_t p = 0; p < places.size(); ++p) {
    points.row(static_cast<Eigen::Index>(p)) = finer * places[p].transpose();
  }
  auto& counts = request.integers["counts"];
  counts.resize(std::ssize(sizes), 1);
  for (std::size_t c = 0; c < sizes.size(); ++c) counts(static_cast<Eigen::Index>(c)) = sizes[c];
  const Eigen::Vector2d size = pixels(finer);
  request.head = JsonObject{{"kind", "drawing"},
                            {"width", size.x()},
                            {"height", size.y()},
                            {"shapes", shapes},
                            {"texts", texts_json(finer)}};
  return request;
}

JsonArray Drawing::texts_json(double finer) const {
  constexpr const char* aligns[] = {"left", "centre", "right"};
  JsonArray texts;
  for (const auto& text : texts_) {
    texts.emplace_back(JsonObject{{"x", finer * text.at.x()},
                                  {"y", finer * text.at.y()},
                                  {"words", text.words},
                                  {"size", finer * text.size},
                                  {"colour", colour_json(text.colour)},
                                  {"align", aligns[static_cast<int>(text.align)]},
                                  {"bold", text.bold ? 1 : 0},
                                  {"upwards", text.upwards ? 1 : 0}});
  }
  return texts;
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
