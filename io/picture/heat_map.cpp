#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "io/figure/view.h"
#include "io/picture/body.h"
#include "io/picture/canvas.h"
#include "io/picture/glyphs.h"
#include "io/picture/map_frame.h"
#include "io/picture/pictures.h"
#include "io/picture/title.h"
#include "mesh/surface.h"

namespace chladni::picture {
namespace {

constexpr double kWidth = 1000.0, kMargin = 40.0, kHeader = 96.0, kRow = 34.0;  // [px]
constexpr Colour kForbidden{0.72, 0.73, 0.75}, kBest{0.90, 0.10, 0.15};
const TextStyle kSmall{.size = 18.0, .colour = kGrey};

// The colour of nodal line k. The map is dark along nodal lines.
Colour line_colour(std::size_t k) {
  constexpr std::array<Colour, 5> colours{{{1.0, 1.0, 1.0},
                                           {1.0, 0.65, 0.25},
                                           {0.45, 0.85, 1.0},
                                           {1.0, 0.55, 0.80},
                                           {0.80, 0.80, 0.80}}};
  return colours[k % colours.size()];
}

void paint_surface(Canvas& canvas, const io::Message& request, const MapFrame& frame) {
  Body map;
  map.points = request.numbers("points");
  map.triangles = request.cells("allowed");
  const auto box = mesh::bounding_box(map.points);
  map.diagonal = (box.row(1) - box.row(0)).norm();
  Body forbidden = map;
  forbidden.triangles = request.cells("forbidden");
  vtkRenderer* space = canvas.panel(frame.corner, frame.size);
  add_map(space, map, request.numbers("value").col(0));
  add_plain(space, forbidden, kForbidden);
  Body whole = map;
  whole.triangles.conservativeResize(map.triangles.rows() + forbidden.triangles.rows(), 3);
  whole.triangles.bottomRows(forbidden.triangles.rows()) = forbidden.triangles;
  const auto& lines = request.numbers("lines");
  for (Eigen::Index k = 0; k < lines.cols(); ++k) {
    const double largest = lines.col(k).cwiseAbs().maxCoeff();
    if (largest <= 0.0) continue;
    add_zero_lines(space, whole, whole.points, lines.col(k) / largest, frame.view,
                   line_colour(static_cast<std::size_t>(k)), 3.0F);
  }
  look(space, frame.view, frame.size.y(), map.diagonal);
}

void paint_star(Canvas& canvas, const Eigen::Vector2d& at, double radius) {
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < 10; ++k) {
    const double angle = std::numbers::pi * (0.2 * k - 0.5);
    const double r = k % 2 == 0 ? radius : 0.42 * radius;
    corners.emplace_back(at.x() + r * std::cos(angle), at.y() + r * std::sin(angle));
  }
  canvas.polygon(corners, kBest, kWhite, 1.2);
}

struct Box {
  Eigen::Vector2d low, high;  // [px]

  [[nodiscard]] bool meets(const Box& other) const {
    return (low.array() < other.high.array()).all() && (other.low.array() < high.array()).all();
  }
};

// A free box for a label beside a star: on the right if there is room, and higher or lower where
// other labels are; not below `bottom`.
Box room_for(double wide, const Eigen::Vector2d& star, const std::vector<Box>& taken,
             double bottom) {
  constexpr double high = 26.0, away = 20.0;
  Box box{};
  for (int step = 0; step < 40; ++step) {  // 0, 0, −1, −1, 1, 1, −2, ...: rows, to the right first
    const int row = (step / 2 + 1) / 2 * (step / 2 % 2 == 1 ? -1 : 1);
    const double left = step % 2 == 0 ? star.x() + away : star.x() - away - wide;
    box.low = {left, star.y() - 0.55 * high + row * (high + 4.0)};
    box.high = box.low + Eigen::Vector2d(wide, high);
    const bool inside = left > 4.0 && box.high.x() < kWidth - 4.0 && box.low.y() > kHeader - high &&
                        box.high.y() < bottom;
    const bool is_free = std::none_of(taken.begin(), taken.end(),
                                      [&](const Box& other) { return box.meets(other); });
    if (inside && is_free) break;
  }
  return box;
}

void paint_best(Canvas& canvas, const io::Message& request, const MapFrame& frame) {
  const auto& places = request.numbers("best");
  const auto& labels = request.head.at("best").array();
  const TextStyle style{.size = 18.0, .colour = kInk, .bold = true};
  const double bottom = frame.corner.y() + frame.size.y() + 18.0;
  std::vector<Box> taken;
  std::vector<Eigen::Vector2d> stars;
  for (const auto place : places.rowwise()) {
    stars.push_back(frame.on_canvas(place.transpose()));
    taken.push_back({stars.back().array() - 13.0, stars.back().array() + 13.0});
  }
  for (std::size_t k = 0; k < stars.size(); ++k) {
    const std::string& words = labels[k].string();
    const Box box = room_for(canvas.text_width(words, style) + 12.0, stars[k], taken, bottom);
    taken.push_back(box);
    const double near = std::clamp(stars[k].x(), box.low.x(), box.high.x());
    const Eigen::Vector2d middle(near, 0.5 * (box.low.y() + box.high.y()));
    canvas.polygon({stars[k], middle}, kWhite, kGrey, 1.0);  // a line between them
    canvas.polygon({box.low, {box.high.x(), box.low.y()}, box.high, {box.low.x(), box.high.y()}},
                   kWhite, kGrey, 0.6);
    canvas.text({box.low.x() + 6.0, box.low.y() + 20.0}, words, style);
  }
  for (auto star = stars.rbegin(); star != stars.rend(); ++star) paint_star(canvas, *star, 13.0);
}

void paint_bar(Canvas& canvas, const io::Message& request, double top) {
  constexpr int steps = 100;
  constexpr double width = 3.0;
  double x = kMargin;
  const std::string& lowest = request.head.at("lowest").string();
  canvas.text({x, top + 15.0}, lowest, kSmall);
  x += canvas.text_width(lowest, kSmall) + 10.0;
  for (int i = 0; i < steps; ++i) {
    paint_rectangle(canvas, x + width * i, top, width + 0.5, 18.0,
                    io::sequential(static_cast<double>(i) / (steps - 1)), 0.0);
  }
  x += width * steps + 10.0;
  const std::string& highest = request.head.at("highest").string();
  canvas.text({x, top + 15.0}, highest, kSmall);
  x += canvas.text_width(highest, kSmall) + 30.0;
  canvas.text({x, top + 15.0}, request.head.at("scale").string(), kSmall);
}

// Paints words after a sign; returns the place after the words.
double paint_entry(Canvas& canvas, double x, double top, const std::string& words) {
  canvas.text({x, top + 15.0}, words, kSmall);
  return x + canvas.text_width(words, kSmall) + 26.0;
}

void paint_legend(Canvas& canvas, const io::Message& request, double top) {
  const auto& lines = request.head.at("lines").array();
  double x = lines.empty() ? kMargin : paint_entry(canvas, kMargin, top, "nodal lines of");
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double wide = 42.0 + canvas.text_width(lines[k].string(), kSmall);
    if (x + wide > kWidth - kMargin - 110.0 && k + 1 < lines.size()) {
      paint_entry(canvas, x, top, "and " + std::to_string(lines.size() - k) + " more");
      break;
    }
    paint_rectangle(canvas, x, top, 34.0, 18.0, io::sequential(0.08), 0.0);
    paint_rectangle(canvas, x, top + 7.5, 34.0, 3.0, line_colour(k), 0.0);
    x = paint_entry(canvas, x + 42.0, top, lines[k].string());
  }
  x = kMargin;
  const double second = lines.empty() ? top : top + kRow;
  if (request.cells("forbidden").rows() > 0) {
    paint_rectangle(canvas, x, second, 34.0, 18.0, kForbidden, 0.6);
    x = paint_entry(canvas, x + 42.0, second, "forbidden");
  }
  if (request.numbers("best").rows() > 0) {
    paint_star(canvas, {x + 10.0, second + 9.0}, 11.0);
    x = paint_entry(canvas, x + 28.0, second, request.head.at("star").string());
  }
  std::map<std::string, std::size_t> kinds;
  for (const auto& marker : request.head.at("markers").array()) ++kinds[marker.at("kind").string()];
  for (const auto& [kind, count] : kinds) {
    draw_glyph(canvas, kind, {x + 8.0, second + 9.0}, 7.0);
    x = paint_entry(canvas, x + 24.0, second, counted_glyphs(kind, count));
  }
}

}  // namespace

std::string heat_map(const io::Message& request) {
  const MapFrame frame =
      map_frame(request.numbers("points"), {kMargin, kHeader}, kWidth - 2.0 * kMargin, 760.0);
  const double below = kHeader + frame.size.y() + 24.0;
  Canvas canvas(static_cast<int>(kWidth), static_cast<int>(std::ceil(below + 3.0 * kRow + 10.0)));
  paint_title(canvas, request.head.at("title").string(), kMargin, kWidth);
  paint_surface(canvas, request, frame);
  const auto& places = request.numbers("marker_places");
  const auto& markers = request.head.at("markers").array();
  for (Eigen::Index m = places.rows() - 1; m >= 0; --m) {
    draw_glyph(canvas, markers[static_cast<std::size_t>(m)].at("kind").string(),
               frame.on_canvas(places.row(m).transpose()), 7.0);
  }
  paint_best(canvas, request, frame);
  paint_bar(canvas, request, below);
  paint_legend(canvas, request, below + kRow);
  return canvas.png();
}

}  // namespace chladni::picture
