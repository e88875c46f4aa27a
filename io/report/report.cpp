#include "io/report.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/figure/colours.h"
#include "io/figure/view.h"
#include "io/json.h"
#include "io/report/page_files.h"

namespace chladni::io {
namespace {

constexpr std::string_view kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'";

void append(std::string& page, const Block& block);

void append(std::string& page, const Note& note) {
  const char* tone = "";
  switch (note.tone) {
    case Note::Tone::plain:
      break;
    case Note::Tone::quiet:
      tone = " class=\"quiet\"";
      break;
    case Note::Tone::good:
      tone = " class=\"good\"";
      break;
    case Note::Tone::warning:
      tone = " class=\"warning\"";
      break;
  }
  page += std::string("<p") + tone + ">" + escaped(note.text) + "</p>\n";
}

void append(std::string& page, const Facts& facts) {
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
  if (row.shape >= 0) page += " data-shape=\"" + std::to_string(row.shape) + "\"";
  page += ">";
  for (std::size_t c = 0; c < row.cells.size(); ++c) {
    page += table.columns[c].is_number ? "<td class=\"number\">" : "<td>";
    page += escaped(row.cells[c]) + "</td>";
  }
  page += "</tr>\n";
}

void append(std::string& page, const Table& table) {
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

void append(std::string& page, const Image& image) {
  page += "<figure><img alt=\"" + escaped(image.caption) + "\" src=\"data:image/png;base64," +
          base64(image.png) + "\">";
  if (!image.caption.empty()) page += "<figcaption>" + escaped(image.caption) + "</figcaption>";
  page += "</figure>\n";
}

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

void append(std::string& page, const Viewer& viewer) {
  page += R"(<div class="viewer">
<div class="stage"><canvas class="back" tabindex="0" aria-label="The body, drawn in the shape of a mode; drag to turn, wheel to zoom, arrow keys for another mode"></canvas>
<canvas class="front"></canvas><div class="label"></div>
<div class="message">The viewer needs scripts; the picture of the modes and the tables do not.</div></div>
<div class="controls"><button type="button" class="previous" title="previous mode">&#8249;</button><button type="button" class="next" title="next mode">&#8250;</button>
<button type="button" class="play">Pause</button><label>amplitude <input type="range" class="amplitude" min="1" max="40" value="12"></label>
<label><input type="checkbox" class="lines" checked> nodal lines</label><label><input type="checkbox" class="names" checked> names</label>
<button type="button" class="reset">Reset view</button><span class="quiet">&#8722;<span class="bar"></span>+ &nbsp;<span class="axis"></span></span></div>
)";
  if (!viewer.note.empty()) page += "<p class=\"quiet\">" + escaped(viewer.note) + "</p>\n";
  page += "<script type=\"application/json\" id=\"viewer-data\">" +
          script_safe(text(viewer_data(viewer))) + "</script>\n</div>\n";
}

void append(std::string& page, const Beside& beside) {
  page += "<div class=\"beside\">\n";
  for (const Block& block : beside.blocks) append(page, block);
  page += "</div>\n";
}

void append(std::string& page, const Block& block) {
  std::visit([&](const auto& content) { append(page, content); }, block);
}

// Everything that html() promises to refuse; counts the viewers.
struct Check {
  int viewers = 0;

  void operator()(const Table& table) const {
    for (const Table::Row& row : table.rows) {
      require(row.cells.size() == table.columns.size(),
              "report: a row of table \"" + table.caption + "\" has " +
                  std::to_string(row.cells.size()) + " cells, expected " +
                  std::to_string(table.columns.size()));
    }
  }
  void operator()(const Image& image) const {
    require(image.png.starts_with("\x89PNG\r\n\x1a\n"),
            "report: the image \"" + image.caption + "\" is no PNG");
  }
  void operator()(const Viewer& viewer) {
    require(++viewers == 1, "report: there is more than one viewer");
    for (const Viewer::Shape& shape : viewer.shapes) {
      require(shape.movement.size() == viewer.points.size(),
              "report: shape \"" + shape.label + "\" has " + std::to_string(shape.movement.size()) +
                  " numbers, expected " + std::to_string(viewer.points.size()));
    }
    require(viewer.markers.size() == viewer.marker_vertex.size(),
            "report: the viewer has another number of markers than of their vertices");
  }
  void operator()(const Beside& beside) {
    for (const Block& block : beside.blocks) std::visit(*this, block);
  }
  void operator()(const Note& /*any*/) const {}
  void operator()(const Facts& /*any*/) const {}
};

std::string anchor(std::size_t section) { return "section-" + std::to_string(section + 1); }

void append_head(std::string& page, const Report& report) {
  page += "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + std::string(kPolicy) +
          "\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<meta name=\"referrer\" content=\"no-referrer\">\n<title>" + escaped(report.title) +
          "</title>\n<style>\n" + std::string(page_css) + "</style>\n</head>\n<body>\n<main>\n";
}

void append_top(std::string& page, const Report& report) {
  page += "<header>\n<h1>" + escaped(report.title) + "</h1>\n";
  if (!report.understood.empty()) {
    page += "<p class=\"understood\">" + escaped(report.understood) + "</p>\n";
  }
  page += "<nav>";
  for (std::size_t s = 0; s < report.sections.size(); ++s) {
    page += "<a href=\"#" + anchor(s) + "\">" + escaped(report.sections[s].title) + "</a>";
  }
  page += "</nav>\n</header>\n";
  for (const std::string& warning : report.warnings) {
    append(page, Note{Note::Tone::warning, warning});
  }
}

}  // namespace

std::string html(const Report& report) {
  Check check;
  for (const Section& section : report.sections) {
    for (const Block& block : section.blocks) std::visit(std::ref(check), block);
  }
  std::string page;
  append_head(page, report);
  append_top(page, report);
  for (std::size_t s = 0; s < report.sections.size(); ++s) {
    const Section& section = report.sections[s];
    page += "<section id=\"" + anchor(s) + "\">\n<h2>" + escaped(section.title) + "</h2>\n";
    for (const Block& block : section.blocks) append(page, block);
    page += "</section>\n";
  }
  page += "</main>\n<script>\n" + std::string(page_js) + "</script>\n</body>\n</html>\n";
  return page;
}

void write_report(const std::filesystem::path& file, const Report& report) {
  write_atomically(file, html(report));
}

}  // namespace chladni::io
