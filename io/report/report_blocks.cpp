#include "io/report/report_blocks.h"

#include <fmt/format.h>

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/bytes/escape.h"
#include "io/figure/colours.h"
#include "io/figure/view.h"
#include "io/json.h"

namespace chladni::io {
namespace {

std::string tone_class(Note::Tone tone) {
  switch (tone) {
    case Note::Tone::plain:
      return "plain";
    case Note::Tone::quiet:
      return "quiet";
    case Note::Tone::good:
      return "good";
    case Note::Tone::warning:
      break;
  }
  return "warning";
}

void append_block(std::string& page, const Note& note) {
  const bool plain = note.tone == Note::Tone::plain;
  page += (plain ? "<p>" : "<p class=\"" + tone_class(note.tone) + "\">") + escaped(note.text) +
          "</p>\n";
}

void append_block(std::string& page, const Card& card) {
  page += "<div class=\"card " + tone_class(card.tone) + "\">\n<p class=\"heading\">" +
          escaped(card.heading) + "</p>\n";
  if (!card.lines.empty()) {
    page += "<ul>\n";
    for (const auto& line : card.lines) page += "<li>" + escaped(line) + "</li>\n";
    page += "</ul>\n";
  }
  if (!card.figures.empty()) {
    page += "<dl class=\"figures\">\n";
    for (const auto& [value, label] : card.figures) {
      page += "<div><dt>" + escaped(label) + "</dt><dd>" + escaped(value) + "</dd></div>\n";
    }
    page += "</dl>\n";
  }
  for (const auto& next : card.next) {
    page += "<p class=\"next\"><b>Next:</b> " + escaped(next) + "</p>\n";
  }
  page += "</div>\n";
}

void append_block(std::string& page, const Facts& facts) {
  page += "<div class=\"facts\">\n";
  if (!facts.title.empty()) page += "<h3>" + escaped(facts.title) + "</h3>\n";
  page += "<dl>\n";
  for (const auto& [name, value] : facts.lines) {
    page += "<dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd>\n";
  }
  page += "</dl>\n</div>\n";
}

void append_row(std::string& page, const Table& table, const Table::Row& row) {
  page += "<tr";
  if (row.is_quiet) page += " class=\"quiet\"";
  if (row.shape >= 0) page += " data-shape=\"" + fmt::to_string(row.shape) + "\"";
  page += ">";
  for (std::size_t c = 0; c < row.cells.size(); ++c) {
    page += table.columns[c].is_number ? "<td class=\"number\">" : "<td>";
    page += escaped(row.cells[c]) + "</td>";
  }
  page += "</tr>\n";
}

void append_block(std::string& page, const Table& table) {
  page += "<div class=\"table\"><table>\n";
  if (!table.caption.empty()) page += "<caption>" + escaped(table.caption) + "</caption>\n";
  page += "<thead><tr>";
  for (const Table::Column& column : table.columns) {
    page += column.is_number ? "<th scope=\"col\" class=\"number\">" : "<th scope=\"col\">";
    page += escaped(column.heading) + "</th>";
  }
  page += "</tr></thead>\n<tbody>\n";
  for (const Table::Row& row : table.rows) append_row(page, table, row);
  page += "</tbody></table></div>\n";
}

void append_block(std::string& page, const Image& image) {
  page += "<figure><img alt=\"" + escaped(image.caption) + "\" src=\"data:image/png;base64," +
          base64(image.png) + "\">";
  if (!image.caption.empty()) page += "<figcaption>" + escaped(image.caption) + "</figcaption>";
  page += "</figure>\n";
}

void append_block(std::string& page, const Listing& listing) {
  page += "<details><summary>" + escaped(listing.title) + "</summary><pre>" +
          escaped(listing.text) + "</pre></details>\n";
}

// One of eleven shades, from the lightest to the darkest value.
std::string shade(const Matrix& matrix, double value) {
  if (!std::isfinite(value)) return "";
  const double part = (value - matrix.light) / (matrix.dark - matrix.light);
  return fmt::format(" class=\"h{}\"", std::lround(10.0 * std::clamp(part, 0.0, 1.0)));
}

void append_block(std::string& page, const Matrix& matrix) {
  page += "<div class=\"table\"><table class=\"matrix\">\n<caption>" + escaped(matrix.title) +
          "</caption>\n<thead><tr><th scope=\"col\">" +
          escaped(matrix.row_label + " \\ " + matrix.column_label) + "</th>";
  for (const auto& name : matrix.columns) page += "<th scope=\"col\">" + escaped(name) + "</th>";
  page += "</tr></thead>\n<tbody>\n";
  for (Eigen::Index i = 0; i < matrix.value.rows(); ++i) {
    page += "<tr><th scope=\"row\">" + escaped(matrix.rows[static_cast<std::size_t>(i)]) + "</th>";
    for (Eigen::Index j = 0; j < matrix.value.cols(); ++j) {
      const double value = matrix.value(i, j);
      page += "<td" + shade(matrix, value) + ">" +
              (std::isfinite(value) ? fmt::format("{:.{}f}", value, matrix.decimals) : "") +
              "</td>";
    }
    page += "</tr>\n";
  }
  page += "</tbody></table></div>\n";
}

void append_block(std::string& page, const Curves& curves) { append_curves(page, curves); }

template <class Number>
std::string packed(const std::vector<Number>& numbers) {  // little-endian, as WebGL's arrays are
  static_assert(std::endian::native == std::endian::little);
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

// The component that gives the colour whole, the other two, which only move the body, in steps of
// 258 (127 times that is 32766): a third fewer bytes.
Json packed_shape(const Viewer::Shape& shape) {
  std::vector<std::int16_t> main;
  std::vector<std::int8_t> sides;
  for (std::size_t i = 0; i < shape.movement.size(); ++i) {
    const int value = shape.movement[i];
    if (static_cast<int>(i % 3) == shape.axis) {
      main.push_back(shape.movement[i]);
    } else {
      sides.push_back(static_cast<std::int8_t>((value + (value < 0 ? -129 : 129)) / 258));
    }
  }
  return JsonObject{{"label", shape.label},
                    {"axis", shape.axis},
                    {"main", packed(main)},
                    {"sides", packed(sides)}};
}

JsonArray colour_bytes() {
  constexpr int count = 65;
  JsonArray bytes;
  for (int i = 0; i < count; ++i) {
    for (const double channel : diverging(2.0 * i / (count - 1) - 1.0)) {
      bytes.emplace_back(static_cast<int>(255.0 * channel + 0.5));
    }
  }
  return bytes;
}

Json viewer_data(const Viewer& viewer) {
  JsonArray shapes, markers, marker_vertex;
  for (const Viewer::Shape& shape : viewer.shapes) {
    shapes.push_back(packed_shape(shape));
  }
  for (const Marker& marker : viewer.markers) {
    markers.emplace_back(JsonObject{{"name", marker.name}, {"kind", marker.kind}});
  }
  for (const int vertex : viewer.marker_vertex) marker_vertex.emplace_back(vertex);
  const Points points =
      Eigen::Map<const Eigen::Matrix<std::int16_t, Eigen::Dynamic, 3, Eigen::RowMajor>>(
          viewer.points.data(), static_cast<Eigen::Index>(viewer.points.size() / 3), 3)
          .cast<double>();
  const Pose pose = pose_of(points);
  return JsonObject{{"points", packed(viewer.points)},
                    {"triangles", packed(viewer.triangles)},
                    {"outline", packed(viewer.outline)},
                    {"shapes", std::move(shapes)},
                    {"markers", std::move(markers)},
                    {"markerVertex", std::move(marker_vertex)},
                    {"colours", colour_bytes()},
                    {"frame", Json::rows(pose.frame)},
                    {"yaw", pose.yaw},
                    {"pitch", pose.pitch}};
}

void append_block(std::string& page, const Viewer& viewer) {
  page += "<div class=\"viewer\" data-paper=\"" + fmt::to_string(viewer.on_paper) + "\">\n";
  page +=
      R"(<div class="stage"><canvas class="back" tabindex="0" role="img" aria-label="The body, drawn in the shape of a mode; drag to turn, wheel to zoom, arrow keys for another mode"></canvas>
<canvas class="front" aria-hidden="true"></canvas><div class="label"></div>
<div class="message">The body needs scripts; the tables do not.</div></div>
<div class="controls"><button type="button" class="previous" title="previous mode" aria-label="previous mode">&#8249;</button><button type="button" class="next" title="next mode" aria-label="next mode">&#8250;</button>
<button type="button" class="play">Pause</button><label>amplitude <input type="range" class="amplitude" min="1" max="40" value="12"></label>
<label><input type="checkbox" class="lines" checked> nodal lines</label><label><input type="checkbox" class="names" checked> names</label>
<button type="button" class="reset">Reset view</button><span class="quiet">&#8722;<span class="bar"></span>+ &nbsp;<span class="axis"></span></span></div>
<div class="sheet"></div>
)";
  if (!viewer.note.empty()) page += "<p class=\"quiet\">" + escaped(viewer.note) + "</p>\n";
  page += "<script type=\"application/json\" id=\"viewer-data\">" +
          script_safe(text(viewer_data(viewer))) + "</script>\n</div>\n";
}

void append_block(std::string& page, const Place& place) {
  std::string names;
  for (const auto& name : place.marked) names += (names.empty() ? "" : ", ") + name;
  page +=
      "<div class=\"viewer place\" data-marked=\"" + escaped(text(Json::texts(place.marked))) +
      "\">\n<div class=\"stage\"><canvas class=\"back\" tabindex=\"0\" role=\"img\" aria-label=\"" +
      escaped("The body with a mark at: " + names + ". Drag to turn, wheel to zoom") +
      "\"></canvas>\n";
  page += R"(<canvas class="front" aria-hidden="true"></canvas><div class="label"></div>
<div class="message">The body needs scripts; the text beside it does not.</div></div>
<div class="controls"><button type="button" class="play">Turn</button>
<button type="button" class="reset">Reset view</button></div>
<div class="sheet"></div>
</div>
)";
}

void append_block(std::string& page, const Beside& beside) {
  page += "<div class=\"beside\">\n";
  for (const Block& block : beside.blocks) append(page, block);
  page += "</div>\n";
}

}  // namespace

void append(std::string& page, const Block& block) {
  std::visit([&](const auto& content) { append_block(page, content); }, block);
}

}  // namespace chladni::io
