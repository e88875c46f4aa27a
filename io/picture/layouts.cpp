#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "io/picture/body.h"
#include "io/picture/glyphs.h"
#include "io/picture/map_frame.h"
#include "io/picture/pictures.h"
#include "io/picture/title.h"
#include "mesh/surface.h"

namespace chladni::picture {
namespace {

constexpr double kWidth = 1000.0, kMargin = 40.0, kGap = 24.0, kHeader = 96.0, kLabel = 50.0;
constexpr double kLegendRow = 30.0;
constexpr std::array kShown{"sensor", "held_out_sensor", "actuator"};
const TextStyle kSmall{.size = 17.0, .colour = kGrey};

void paint_panel(Canvas& canvas, const io::Message& request, std::size_t number, const Body& body,
                 const MapFrame& frame) {
  const auto& panel = request.head.at("panels").array()[number];
  vtkRenderer* space = canvas.panel(frame.corner, frame.size);
  add_map(space, body, request.numbers("values").col(static_cast<Eigen::Index>(number)));
  look(space, frame.view, frame.size.y(), body.diagonal);
  const auto& places = request.numbers("places_" + std::to_string(number));
  const auto& kinds = panel.at("kinds").array();
  for (const char* kind : kShown) {
    for (Eigen::Index m = 0; m < places.rows(); ++m) {
      if (kinds[static_cast<std::size_t>(m)].string() != kind) continue;
      draw_glyph(canvas, kind, frame.on_canvas(places.row(m).transpose()), 6.0);
    }
  }
  canvas.text(frame.corner - Eigen::Vector2d(0.0, 28.0), panel.at("title").string(),
              {.size = 19.0, .bold = true});
  canvas.text(frame.corner - Eigen::Vector2d(0.0, 8.0), panel.at("note").string(), kSmall);
}

void paint_bar(Canvas& canvas, const io::Message& request, double top) {
  constexpr int steps = 80;
  double x = kMargin;
  for (const bool first : {true, false}) {
    const std::string& words = request.head.at(first ? "lightest" : "darkest").string();
    canvas.text({x, top + 15.0}, words, kSmall);
    x += canvas.text_width(words, kSmall) + 12.0;
    for (int i = 0; first && i < steps; ++i) {
      paint_rectangle(canvas, x, top, 3.5, 18.0,
                      io::sequential(1.0 - std::sqrt(static_cast<double>(i) / (steps - 1))), 0.0);
      x += 3.0;
    }
    x += 10.0;
  }
  canvas.text({x + 10.0, top + 15.0}, request.head.at("scale").string(), kSmall);
}

// The signs that the panels have. Panels differ in their channels, so none are counted.
void paint_signs(Canvas& canvas, const io::Message& request, double top) {
  std::set<std::string> there;
  for (const auto& panel : request.head.at("panels").array()) {
    for (const auto& kind : panel.at("kinds").array()) there.insert(kind.string());
  }
  double x = kMargin;
  for (const std::string kind : kShown) {
    if (!there.contains(kind)) continue;
    std::string words = kind;
    std::ranges::replace(words, '_', ' ');
    draw_glyph(canvas, kind, {x + 8.0, top + 9.0}, 7.0);
    canvas.text({x + 24.0, top + 15.0}, words, kSmall);
    x += 24.0 + canvas.text_width(words, kSmall) + 26.0;
  }
}

}  // namespace

std::string layouts(const io::Message& request) {
  Body body;
  body.points = request.numbers("points");
  body.triangles = request.cells("triangles");
  const auto box = mesh::bounding_box(body.points);
  body.diagonal = (box.row(1) - box.row(0)).norm();
  const auto count = static_cast<int>(request.head.at("panels").array().size());
  const int columns = std::clamp(count, 2, 3);
  const int rows = (count + columns - 1) / columns;
  const double width = (kWidth - 2.0 * kMargin - (columns - 1) * kGap) / columns;
  const MapFrame sample = map_frame(body.points, {0.0, 0.0}, width, 460.0);
  const double pitch = sample.size.y() + kLabel + kGap;
  const double below = kHeader + rows * pitch + 4.0;
  Canvas canvas(static_cast<int>(kWidth), static_cast<int>(std::ceil(below + kLegendRow + 44.0)));
  paint_title(canvas, request.head.at("title").string(), kMargin, kWidth);
  for (int p = 0; p < count; ++p) {
    const Eigen::Vector2d corner(kMargin + (p % columns) * (width + kGap),
                                 kHeader + kLabel + (p / columns) * pitch);
    paint_panel(canvas, request, static_cast<std::size_t>(p), body,
                map_frame(body.points, corner, width, 460.0));
  }
  paint_bar(canvas, request, below);
  paint_signs(canvas, request, below + kLegendRow);
  return canvas.png();
}

}  // namespace chladni::picture
