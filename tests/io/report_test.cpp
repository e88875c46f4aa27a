// The report is data; what it promises of the page is tested on the page.
#include "io/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "base/error.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "io/bytes/escape.h"
#include "io/json.h"
#include "io/report_sections.h"
#include "mesh/surface.h"
#include "tests/io/reports.h"

namespace chladni::io {
namespace {

// The bytes of a base64 text.
std::string decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0, bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    word = word << 6U | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits & 255U);
  }
  return bytes;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t times = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++times;
  }
  return times;
}

TEST(Report, NeedsNothingButItself) {
  const std::string page = html(report_of(12, "plate"));
  EXPECT_NE(page.find("default-src 'none'; style-src 'sha256-"), std::string::npos);
  EXPECT_EQ(page.find("unsafe"), std::string::npos);
  for (const std::string outside :
       {"http:", "https:", "//cdn", "@import", "url(", "<link", "<iframe", "fetch(",
        "XMLHttpRequest", "import(", "eval(", "innerHTML"}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
}

// The policy names each script and style sheet of the page by its sha256, and nothing else.
TEST(Report, ThePolicyAllowsTheScriptsOfThePageAlone) {
  const std::string page = html(with_verdict(report_of(12, "plate"), "plate"));
  const auto from = page.find("script-src"), to = page.find(';', from);
  const std::string allowed = page.substr(from, to - from);
  std::size_t scripts = 0;
  for (const auto& [open, close, list] :
       {std::tuple{std::string("<script>"), std::string("</script>"), allowed},
        {"<style>", "</style>", page.substr(page.find("style-src"), 80)}}) {
    for (auto at = page.find(open); at != std::string::npos; at = page.find(open, at + 1)) {
      const auto content = at + open.size();
      const std::string digits = sha256(page.substr(content, page.find(close, content) - content));
      std::string bytes;
      for (std::size_t i = 0; i < digits.size(); i += 2) {
        bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
      }
      EXPECT_NE(list.find("'sha256-" + base64(bytes) + "'"), std::string::npos) << open;
      ++scripts;
    }
  }
  EXPECT_EQ(scripts, 3U);
  EXPECT_EQ(count(allowed, "sha256-"), 2U);
  EXPECT_EQ(page.find("https:"), std::string::npos);
  EXPECT_NE(page.find("Copyright (c) 2022 Leon Sorokin"), std::string::npos);
}

// What is in the repository is what was released: vendor/uplot/README has the digests.
TEST(Report, TheLibraryOfCurvesIsUnchanged) {
  const std::filesystem::path folder = CHLADNI_SOURCE_DIR "/io/report/vendor/uplot";
  const std::string readme = read_whole(folder / "README");
  for (const std::string name : {"uPlot.iife.min.js", "uPlot.min.css"}) {
    EXPECT_NE(readme.find(sha256_of_file(folder / name) + "  " + name), std::string::npos) << name;
  }
}

TEST(Report, APageWithoutCurvesDoesNotCarryTheirLibrary) {
  EXPECT_EQ(html(report_of(12, "plate")).find("uPlot"), std::string::npos);
  EXPECT_NE(html({"", "", {}, {{"", {curves_of_two()}}}}).find("uPlot"), std::string::npos);
}

TEST(Report, TheVerdictStandsBeforeTheWarnings) {
  const Report report = report_of(12, "plate");
  const auto place = [](const std::string& page, const char* what) { return page.find(what); };
  std::string page = html(with_verdict(report, "plate"));
  EXPECT_LT(place(page, "class=\"heading\">Named"), place(page, "a warning plate"));
  EXPECT_LT(place(page, "a warning plate"), place(page, ">Evidence</h2>"));
  page = html(report);
  EXPECT_LT(place(page, "a warning plate"), place(page, "<section"));
}

// Codes are decoded as the page does; the limits of a pane are those of all its values.
TEST(Report, CurvesReadBackToTheStepsOfTheirPane) {
  Curves curves = curves_of_two();
  curves.choices[1].y[2](7) = NAN;
  curves.choices[1].y[3](8) = -1.0;
  const std::string page = html({"", "", {}, {{"", {curves}}}});
  const std::string opening = "<script type=\"application/json\">";
  const auto from = page.find(opening) + opening.size();
  const Json data = parse_json(page.substr(from, page.find("</script>", from) - from));
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t a = 0; a < 5; ++a) {
      const Json& pane = data.at("panes").array()[a < 4 ? 0 : 1];
      const double low = pane.at("low").number(), high = pane.at("high").number();
      const std::string bytes = decoded(data.at("choices").array()[c].at("y").array()[a].string());
      const std::size_t width = a < 4 ? 2 : 1;
      ASSERT_EQ(bytes.size(), 200 * width);
      for (std::size_t k = 0; k < 200; ++k) {
        unsigned code = static_cast<unsigned char>(bytes[k * width]);
        if (width == 2) code += 256U * static_cast<unsigned char>(bytes[2 * k + 1]);
        const double value = curves.choices[c].y[a](static_cast<Eigen::Index>(k));
        if (!std::isfinite(value) || (a < 4 && value <= 0.0)) {
          EXPECT_EQ(code, 0U);
          continue;
        }
        const double part = (code - 1.0) / (a < 4 ? 65534.0 : 254.0);
        const double read = a < 4 ? low * std::pow(high / low, part) : low + (high - low) * part;
        const double step = a < 4 ? value * std::log(high / low) / 65534.0 : (high - low) / 254.0;
        EXPECT_NEAR(read, value, 0.51 * step) << c << " " << a << " " << k;
      }
    }
  }
}

TEST(Report, AMatrixIsATableOfShades) {
  const std::string page = html({"", "", {}, {{"", {likeness()}}}});
  for (const auto* cell : {"<td class=\"h10\">1.00</td>", "<td class=\"h3\">0.25</td>",
                           "<td class=\"h0\">0.00</td>", "<td class=\"h10\">0.96</td>", "<td></td>",
                           "<th scope=\"row\">200 Hz</th>", "<th scope=\"col\">303 Hz</th>"}) {
    EXPECT_NE(page.find(cell), std::string::npos) << cell;
  }
}

TEST(Report, NamesCannotBecomeMarkup) {
  const std::string plain = html(with_verdict(report_of(12, "plate"), "plate"));
  const std::string page = html(with_verdict(report_of(12, kHostile), kHostile));
  EXPECT_EQ(page.find("<img"), std::string::npos);
  for (const std::string part : {"<script", "</script", "<!--", "<td", "<tr", "<p", "<dt"}) {
    EXPECT_EQ(count(page, part), count(plain, part)) << part;
  }
  EXPECT_GE(count(page, escaped(kHostile)), 7U);  // title twice, understood, warning, table, facts
}

TEST(Report, TheViewersDataReadBack) {
  const std::string page = html(report_of(12, kHostile));
  const std::string opening = "id=\"viewer-data\">";
  const std::size_t from = page.find(opening) + opening.size();
  const Json data = parse_json(page.substr(from, page.find("</script>", from) - from));
  EXPECT_EQ(data.at("shapes").array().size(), 12U);
  EXPECT_EQ(data.at("shapes").array()[0].at("axis").number(), 2.0);
  EXPECT_EQ(data.at("markers").array()[0].at("name").string(), kHostile);
}

TEST(Report, TwelveModesWithAPictureStayBelowOneMegabyte) {
  const mesh::TetMesh mesh = plate(0.015);
  const modal::Modes modes = modes_of(mesh, 12);
  Report report = report_of(12, "plate");
  report.sections[0] = modes_section(mesh, modes, summary_of(modes), {});
  EXPECT_LT(html(report).size(), 400'000U);  // the picture has 550 kB at most
}

TEST(Report, TheSameReportGivesTheSameBytes) {
  const auto page = [] { return html(with_verdict(report_of(12, "plate"), "plate")); };
  EXPECT_EQ(page(), page());
}

TEST(Report, RigidBodyModesAreOneQuietRow) {
  const std::string page = html(report_of(12, "plate"));
  EXPECT_NE(page.find("<tr class=\"quiet\"><td class=\"number\">1 to 6</td><td>rigid body</td>"
                      "<td class=\"number\">0</td>"),
            std::string::npos);
  EXPECT_EQ(count(page, "<tr data-shape="), 12U);
}

TEST(Report, AModesRowTellsFrequencyErrorResidualAndItsPair) {
  const std::string page = html(report_of(12, "plate"));
  EXPECT_NE(page.find("<td class=\"number\">7</td><td>flexible 1</td><td class=\"number\">178.92"
                      "</td><td class=\"number\">0.36</td><td class=\"number\">3e-11</td>"),
            std::string::npos);
  EXPECT_NE(page.find("<td>pair with 11</td>"), std::string::npos);
  EXPECT_NE(page.find("<td>pair with 10</td>"), std::string::npos);
  EXPECT_EQ(count(page, "<td>one of 3: 13 to 15</td>"), 3U);
}

TEST(Report, ACertificateIsGoodAndItsAbsenceAWarning) {
  const mesh::TetMesh mesh = plate();
  const modal::Modes modes = modes_of(mesh, 3);
  fem::ModesSummary summary = summary_of(modes);
  summary.clusters.clear();
  const auto tone = [&] {
    const Section section = modes_section(mesh, modes, summary, {});
    return std::get<Note>(section.blocks[1]).tone;
  };
  EXPECT_EQ(tone(), Note::Tone::good);
  summary.complete = false;
  EXPECT_EQ(tone(), Note::Tone::warning);
}

TEST(Report, TheViewerShowsTheShapesToSixteenBits) {
  const mesh::TetMesh mesh = plate();
  const modal::Modes modes = modes_of(mesh, 2);
  const Viewer viewer = modes_viewer(mesh, modes);
  const auto box = mesh::bounding_box(mesh.points);
  const double half = 0.5 * (box.row(1) - box.row(0)).norm();
  const Eigen::RowVector3d centre = 0.5 * (box.row(0) + box.row(1));
  double largest = 0.0;
  for (Eigen::Index i = 0; i < mesh.node_count(); ++i) {
    largest = std::max(largest, modes.shapes.col(6).segment<3>(3 * i).norm());
  }
  for (std::size_t v = 0; v < viewer.points.size(); v += 3) {
    Eigen::RowVector3d at;
    for (Eigen::Index c = 0; c < 3; ++c) {
      at(c) = centre(c) + half * viewer.points[v + static_cast<std::size_t>(c)] / 32767.0;
    }
    Eigen::Index node = 0;
    ASSERT_LT((mesh.points.rowwise() - at).rowwise().norm().minCoeff(&node), 2.0 * half / 32767.0);
    EXPECT_NEAR(viewer.shapes[0].movement[v + 2] / 32767.0, modes.shapes(3 * node + 2, 6) / largest,
                1.0 / 32767.0);
  }
}

TEST(Report, AViewerOfAFineMeshSaysWhatItLeftOut) {
  const mesh::TetMesh mesh = plate(0.015);
  const Viewer viewer = modes_viewer(mesh, modes_of(mesh, 20));
  EXPECT_LE(viewer.points.size() / 3, 20'000U);
  EXPECT_NE(viewer.note.find("of the"), std::string::npos);
  EXPECT_LT(html({"", "", {}, {{"", {viewer}}}}).size(), 400'000U);
  EXPECT_EQ(modes_viewer(plate(), modes_of(plate(), 2)).note, "");
}

TEST(Report, ZerosHaveNoSignAndAxesHaveNames) {
  const std::vector<Marker> markers{{"s", "sensor", {-1e-9, 0.25, 0.0}, {0.0, 0.0, -2.0}},
                                    {"t", "sensor", {0.0, 0.0, 0.0}, {0.6, 0.8, 0.0}}};
  const std::string page = html({"", "", {}, {channels_section(markers, {}, {})}});
  EXPECT_NE(page.find("0.0, 250.0, 0.0"), std::string::npos);
  EXPECT_EQ(page.find("-0.0"), std::string::npos);
  EXPECT_NE(page.find("<td>−z</td>"), std::string::npos);
  EXPECT_NE(page.find("<td>0.600, 0.800, 0.000</td>"), std::string::npos);
}

TEST(Report, WhatDoesNotFitTogetherIsRefused) {
  const mesh::TetMesh mesh = plate();
  const modal::Modes modes = modes_of(mesh, 3);
  const Table ragged{"", {{"a"}, {"b"}}, {{{"1"}}}};
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {ragged}}}})), InvalidInput);
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {Image{"GIF89a", ""}}}}})), InvalidInput);
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {Place{{"s"}}}}}})), InvalidInput);
  MatrixPicture nameless = likeness();
  nameless.rows.pop_back();
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {nameless}}}})), InvalidInput);
  Curves curves = curves_of_two();
  curves.choices[1].y[2].conservativeResize(199);
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {curves}}}})), InvalidInput);
  curves.choices[1].y.pop_back();
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {curves}}}})), InvalidInput);
  curves.choices.clear();
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {curves}}}})), InvalidInput);
  const Viewer viewer = modes_viewer(mesh, modes);
  EXPECT_THROW(static_cast<void>(html({"", "", {}, {{"", {viewer, Beside{{viewer}}}}}})),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(modes_section(mesh, modes, {}, {})), InvalidInput);
  EXPECT_THROW(static_cast<void>(channels_section({}, modes, Eigen::MatrixXd::Ones(2, 2))),
               InvalidInput);
}

// The script runs in a real browser, where there is one: the row of the first mode is marked.
TEST(Report, ABrowserShowsTheFirstMode) {
  if (std::system("command -v chromium > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "chromium is not installed: the report's script was not run";
  }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("chladni_report_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  write_report(folder / "report.html", report_of(12, kHostile));
  const std::string command =
      "timeout 60 chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader "
      "--enable-unsafe-swiftshader --force-prefers-reduced-motion --virtual-time-budget=3000 "
      "--user-data-dir=" +
      (folder / "profile").string() + " --dump-dom 'file://" + (folder / "report.html").string() +
      "' > " + (folder / "dom.html").string() + " 2> /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string page = read_whole(folder / "dom.html");
  std::filesystem::remove_all(folder);
  EXPECT_NE(page.find("<div class=\"label\">7 (flex 1)   178.92 Hz</div>"), std::string::npos);
  EXPECT_NE(page.find("<div class=\"message\" hidden=\"\">"), std::string::npos);
  EXPECT_TRUE(std::regex_search(page, std::regex("<tr data-shape=\"0\"[^>]*class=\"shown\"")));
  EXPECT_EQ(page.find("<img"), std::string::npos);
}

// A reader zooms, chooses, copies, saves and prints; see report_in_browser.py.
TEST(Report, AReaderCanUseIt) {
  if (std::system("command -v chromium > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "chromium is not installed: the report was used by nobody";
  }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("chladni_reader_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  write_report(folder / "report.html", with_verdict(report_of(12, "plate"), "plate"));
  const std::string command =
      "timeout 110 /usr/bin/python3 " CHLADNI_SOURCE_DIR "/tests/io/report_in_browser.py '" +
      (folder / "report.html").string() + "' > '" + (folder / "faults").string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << read_whole(folder / "faults");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace chladni::io
