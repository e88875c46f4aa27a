// A drawing as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/bytes/escape.h"
#include "io/figure/drawing.h"

namespace chladni::io {
namespace {

constexpr double kSeam = 0.4;  // [px] around polygons: neighbours would leave a light line between

std::string colour_text(const Colour& colour) {
  const auto part = [&](std::size_t c) { return std::lround(255.0 * colour[c]); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(0), part(1), part(2));
}

std::string number(double value) {
  auto text = fmt::format("{:.2f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

// A word of several lines stands on one: control characters are spaces.
std::string words_text(std::string words) {
  std::ranges::replace_if(
      words, [](unsigned char c) { return c < 0x20U; }, ' ');
  return escaped(words);
}

std::string path_text(const std::vector<Drawing::Path>& paths, bool closed) {
  std::string text;
  for (const auto& path : paths) {
    for (std::size_t p = 0; p < path.size(); ++p) {
      text += fmt::format("{}{} {}", p == 0 ? 'M' : 'L', number(path[p].x()), number(path[p].y()));
    }
    if (closed) text += 'Z';
  }
  return text;
}

}  // namespace

std::string Drawing::svg(double width_mm) const {
  constexpr const char* anchors[] = {"start", "middle", "end"};
  const auto width = number(width_);
  const auto height = number(height_);
  const auto on_paper = [&](double pixels) {
    return width_mm > 0.0 ? number(width_mm * pixels / width_) + "mm" : number(pixels);
  };
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{2}\" height=\"{3}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      width, height, on_paper(width_), on_paper(height_));
  const auto out = std::back_inserter(text);
  for (const auto& shape : shapes_) {
    const auto colour = colour_text(shape.colour);
    fmt::format_to(out,
                   "<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\" "
                   "stroke-linejoin=\"round\"/>\n",
                   path_text(shape.paths, shape.filled), shape.filled ? colour : "none", colour,
                   number(shape.filled ? kSeam : shape.width));
  }
  for (const auto& words : texts_) {
    const auto x = number(words.at.x());
    const auto y = number(words.at.y());
    fmt::format_to(out,
                   "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{}\"{}{}>"
                   "{}</text>\n",
                   x, y, number(words.size), colour_text(words.colour),
                   anchors[static_cast<int>(words.align)],
                   words.bold ? " font-weight=\"bold\"" : "",
                   words.upwards ? fmt::format(" transform=\"rotate(-90 {} {})\"", x, y) : "",
                   words_text(words.words));
  }
  return text + "</svg>\n";
}

}  // namespace chladni::io
