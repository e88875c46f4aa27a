#include "io/report.h"

#include <fmt/format.h>

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "io/bytes/escape.h"
#include "io/report/page_files.h"
#include "io/report/report_blocks.h"

namespace chladni::io {
namespace {

// Everything that html() promises to refuse; counts the viewers.
struct Check {
  int viewers = 0, places = 0;

  void operator()(const Table& table) const {
    for (const Table::Row& row : table.rows) {
      require(row.cells.size() == table.columns.size(),
              "report: a row of table \"" + table.caption + "\" has " +
                  fmt::to_string(row.cells.size()) + " cells, expected " +
                  fmt::to_string(table.columns.size()));
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
              "report: shape \"" + shape.label + "\" has " + fmt::to_string(shape.movement.size()) +
                  " numbers, expected " + fmt::to_string(viewer.points.size()));
    }
    require(viewer.markers.size() == viewer.marker_vertex.size(),
            "report: the viewer has another number of markers than of their vertices");
  }
  void operator()(const Matrix& matrix) const {
    require(matrix.value.rows() == std::ssize(matrix.rows) &&
                matrix.value.cols() == std::ssize(matrix.columns),
            fmt::format("report: matrix \"{}\" is {} x {} and has {} and {} names", matrix.title,
                        matrix.value.rows(), matrix.value.cols(), matrix.rows.size(),
                        matrix.columns.size()));
  }
  void operator()(const Curves& curves) const { check_curves(curves); }
  void operator()(const Place& /*any*/) { ++places; }
  void operator()(const Beside& beside) {
    for (const Block& block : beside.blocks) std::visit(*this, block);
  }
  void operator()(const Note& /*any*/) const {}
  void operator()(const Card& /*any*/) const {}
  void operator()(const Listing& /*any*/) const {}
  void operator()(const Facts& /*any*/) const {}
};

std::string anchor(std::size_t section) { return "section-" + fmt::to_string(section + 1); }

bool has_curves(const std::vector<Block>& blocks) {
  return std::ranges::any_of(blocks, [](const Block& block) {
    const auto* beside = std::get_if<Beside>(&block);
    return std::holds_alternative<Curves>(block) ||
           (beside != nullptr && has_curves(beside->blocks));
  });
}

// 'sha256-...', by which a policy allows one script or style sheet.
std::string allowed(std::string_view content) {
  const std::string digits = sha256(content);
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  return " 'sha256-" + base64(bytes) + "'";
}

// Everything that the browser runs or applies.
struct Allowed {
  std::string style;
  std::vector<std::string> scripts;
};

Allowed allowed_of(const Report& report) {
  Allowed page{std::string(page_css), {}};
  const bool curves = std::ranges::any_of(
      report.sections, [](const Section& section) { return has_curves(section.blocks); });
  if (curves) {
    // The first line of the released file is a comment with an address; the licence replaces it.
    page.style = std::string(uplot_css) + "\n" + page.style;
    page.scripts.push_back("/* uPlot\n" + std::string(uplot_licence) + "\n*/\n" +
                           std::string(uplot_js.substr(uplot_js.find('\n') + 1)));
  }
  page.scripts.push_back(std::string(page_js) + std::string(viewer_js) + std::string(tables_js) +
                         (curves ? std::string(plot_js) + std::string(curves_js) : ""));
  return page;
}

std::string policy(const Allowed& parts) {
  std::string scripts;
  for (const auto& script : parts.scripts) scripts += allowed(script);
  return "default-src 'none'; style-src" + allowed(parts.style) + "; script-src" + scripts +
         "; img-src data:; base-uri 'none'; form-action 'none'";
}

void append_head(std::string& page, const Report& report, const Allowed& parts) {
  page += "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy(parts) +
          "\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<meta name=\"referrer\" content=\"no-referrer\">\n<title>" + escaped(report.title) +
          "</title>\n<style>" + parts.style + "</style>\n</head>\n<body>\n<main>\n";
}

void append_top(std::string& page, const Report& report) {
  page += "<header>\n<h1>" + escaped(report.title) + "</h1>\n";
  if (!report.understood.empty()) {
    page += "<p class=\"understood\">" + escaped(report.understood) + "</p>\n";
  }
  page += "<nav aria-label=\"sections\">";
  for (std::size_t s = 0; s < report.sections.size(); ++s) {
    page += "<a href=\"#" + anchor(s) + "\">" + escaped(report.sections[s].title) + "</a>";
  }
  page += "</nav>\n</header>\n";
}

void append_warnings(std::string& page, const Report& report) {
  for (const std::string& warning : report.warnings) {
    append(page, Note{Note::Tone::warning, warning});
  }
}

bool has_card(const std::vector<Block>& blocks) {
  return !blocks.empty() && (std::holds_alternative<Card>(blocks[0]) ||
                             (std::holds_alternative<Beside>(blocks[0]) &&
                              has_card(std::get<Beside>(blocks[0]).blocks)));
}

}  // namespace

std::string html(const Report& report) {
  Check check;
  for (const Section& section : report.sections) {
    for (const Block& block : section.blocks) std::visit(std::ref(check), block);
  }
  require(check.places == 0 || check.viewers == 1, "report: a place is marked without a viewer");
  const Allowed parts = allowed_of(report);
  std::string page;
  append_head(page, report, parts);
  append_top(page, report);
  // The verdict stands before the warnings.
  const bool card_first = !report.sections.empty() && has_card(report.sections[0].blocks);
  if (!card_first) append_warnings(page, report);
  for (std::size_t s = 0; s < report.sections.size(); ++s) {
    const Section& section = report.sections[s];
    page += "<section id=\"" + anchor(s) + "\" aria-labelledby=\"" + anchor(s) +
            "-title\">\n<h2 id=\"" + anchor(s) + "-title\">" + escaped(section.title) + "</h2>\n";
    for (const Block& block : section.blocks) append(page, block);
    page += "</section>\n";
    if (card_first && s == 0) append_warnings(page, report);
  }
  page += "</main>\n<svg class=\"unseen\" aria-hidden=\"true\"></svg>\n";
  for (const auto& script : parts.scripts) page += "<script>" + script + "</script>\n";
  page += "</body>\n</html>\n";
  return page;
}

void write_report(const std::filesystem::path& file, const Report& report) {
  write_atomically(file, html(report));
}

}  // namespace chladni::io
