// The report is data; what it promises of the page is tested on the page.
#include "io/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/json.h"
#include "io/report_sections.h"
#include "mesh/bodies.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

const std::string kHostile = "</script><img src=x onerror=alert(1)>\"'<!--&";

mesh::TetMesh plate(double edge = 0.1) {
  return with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, edge, 1), 2);
}

modal::Modes modes_of(const mesh::TetMesh& mesh, Eigen::Index flexible) {
  modal::Modes modes;
  const Eigen::Index count = flexible + 6;
  modes.rigid_count = 6;
  modes.frequency_hz = Eigen::VectorXd::Zero(count);
  modes.frequency_hz.tail(flexible) = Eigen::VectorXd::LinSpaced(
      flexible, 178.9199, 178.9199 + 90.0 * static_cast<double>(flexible - 1));
  modes.damping_ratio = Eigen::VectorXd::Zero(count);
  modes.shapes = Eigen::MatrixXd::Zero(3 * mesh.node_count(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index i = 0; i < mesh.node_count(); ++i) {
      const double x = mesh.points(i, 0), y = mesh.points(i, 1);
      modes.shapes(3 * i, k) = 0.1 * x;
      modes.shapes(3 * i + 2, k) = std::sin(4.0 * static_cast<double>(k) * x) * std::cos(9.0 * y);
    }
  }
  return modes;
}

fem::ModesSummary summary_of(const modal::Modes& modes) {
  fem::ModesSummary summary;
  summary.residual = Eigen::VectorXd::Constant(modes.mode_count(), 3e-11);
  summary.complete = true;
  summary.text = "modes below 2000 Hz: 34 found, 34 counted";
  summary.clusters = {{9, 2}, {12, 3}};
  return summary;
}

Report report_of(Eigen::Index flexible, const std::string& name) {
  const mesh::TetMesh mesh = plate();
  const modal::Modes modes = modes_of(mesh, flexible);
  const std::vector<Marker> markers{{name, "sensor", {0.25, 0.25, 0.0}, {0.0, 0.0, 1.0}},
                                    {"a1", "actuator", {-0.2, 0.2, 0.0}, {0.0, 0.0, -1.0}}};
  fem::MassProperties mass{
      19.44, {0.0, 0.0, -0.01}, Eigen::Vector3d(0.58, 0.58, 1.17).asDiagonal()};
  Report report{name, "600.0 x 600.0 x 20.0 mm " + name, {"a warning " + name}, {}};
  report.sections = {
      modes_section(mesh, modes, summary_of(modes),
                    Eigen::VectorXd::Constant(modes.mode_count(), 2e-3), markers),
      body_section(mass, mesh, mesh::quality(mesh), 9801),
      channels_section(markers, modes, Eigen::MatrixXd::Constant(2, modes.mode_count(), 0.125)),
      provenance_section({{"study", name}, {name, "sha256"}})};
  return report;
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
  EXPECT_NE(page.find("default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
                      "img-src data:"),
            std::string::npos);
  for (const std::string outside :
       {"http:", "https:", "//cdn", "@import", "url(", "<link", "<iframe", "fetch(",
        "XMLHttpRequest", "import(", "eval(", "innerHTML"}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
}

TEST(Report, NamesCannotBecomeMarkup) {
  const std::string plain = html(report_of(12, "plate"));
  const std::string page = html(report_of(12, kHostile));
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
  EXPECT_EQ(html(report_of(12, "plate")), html(report_of(12, "plate")));
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

}  // namespace
}  // namespace chladni::io
