#include "base/error.h"
#include "io/picture/canvas.h"
#include "io/picture/pictures.h"

namespace chladni::picture {
namespace {

Colour colour_of(const io::Json& json) {
  const auto& parts = json.array();
  require(parts.size() == 3, "a colour of other than three numbers");
  return {parts[0].number(), parts[1].number(), parts[2].number()};
}

TextStyle style_of(const io::Json& text) {
  TextStyle style{.size = text.at("size").number(), .colour = colour_of(text.at("colour"))};
  style.bold = text.at("bold").number() > 0.0;
  style.upwards = text.at("upwards").number() > 0.0;
  const std::string& align = text.at("align").string();
  if (align == "centre") style.align = TextStyle::Align::centre;
  if (align == "right") style.align = TextStyle::Align::right;
  return style;
}

}  // namespace

std::string drawing(const io::Message& request) {
  const auto& points = request.numbers("points");
  const auto& counts = request.cells("counts");
  Canvas canvas(static_cast<int>(request.head.at("width").number()),
                static_cast<int>(request.head.at("height").number()));
  Eigen::Index point = 0, count = 0;
  for (const auto& shape : request.head.at("shapes").array()) {
    std::vector<std::vector<Eigen::Vector2d>> paths;
    const auto size = static_cast<Eigen::Index>(shape.at("paths").number());
    for (Eigen::Index p = 0; p < size; ++p, ++count) {
      require(count < counts.size() && point + counts(count) <= points.rows(),
              "a drawing with fewer points than it says");
      auto& path = paths.emplace_back();
      for (std::int32_t i = 0; i < counts(count); ++i) path.emplace_back(points.row(point++));
    }
    const auto colour = colour_of(shape.at("colour"));
    if (shape.at("kind").string() == "lines") {
      canvas.lines(paths, colour, shape.at("width").number());
    } else {
      canvas.polygons(paths, colour);
    }
  }
  for (const auto& text : request.head.at("texts").array()) {
    canvas.text({text.at("x").number(), text.at("y").number()}, text.at("words").string(),
                style_of(text));
  }
  return canvas.png();
}

}  // namespace chladni::picture
