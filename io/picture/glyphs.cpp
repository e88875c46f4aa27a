#include "io/picture/glyphs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chladni::picture {
namespace {

constexpr Colour kSensor{1.0, 0.84, 0.10}, kActuator{0.10, 0.45, 0.26}, kOther{0.55, 0.57, 0.60};

std::vector<Eigen::Vector2d> regular(const Eigen::Vector2d& at, double radius, int corners,
                                     double first) {
  std::vector<Eigen::Vector2d> result;
  for (int i = 0; i < corners; ++i) {
    const double angle = first + 2.0 * std::numbers::pi * i / corners;
    result.emplace_back(at.x() + radius * std::cos(angle), at.y() + radius * std::sin(angle));
  }
  return result;
}

}  // namespace

std::string counted_glyphs(const std::string& kind, std::size_t count) {
  const char* plural = kind.ends_with("ss") ? "es" : "s";
  std::string words = std::to_string(count) + " " + kind + (count == 1 ? "" : plural);
  std::ranges::replace(words, '_', ' ');
  return words;
}

int glyph_layer(const std::string& kind) {
  return kind == "sensor" || kind == "held_out_sensor" ? 2 : kind == "actuator" ? 1 : 0;
}

void draw_glyph(Canvas& canvas, const std::string& kind, const Eigen::Vector2d& at, double radius) {
  if (kind == "sensor" || kind == "held_out_sensor") {
    canvas.polygon(regular(at, 0.85 * radius, 24, 0.0), kind == "sensor" ? kSensor : kWhite, kInk,
                   1.2);
  } else if (kind == "actuator") {
    canvas.polygon(regular(at, 1.5 * radius, 3, -std::numbers::pi / 2), kActuator, kWhite, 1.2);
  } else {
    canvas.polygon(regular(at, 1.1 * radius, 4, std::numbers::pi / 4), kOther, kInk, 1.0);
  }
}

}  // namespace chladni::picture
