// Reports to try the page with.
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "io/report.h"
#include "io/report_sections.h"
#include "mesh/bodies.h"
#include "mesh/surface.h"

namespace chladni::io {

inline const std::string kHostile = "</script><img src=x onerror=alert(1)>\"'<!--&";

inline mesh::TetMesh plate(double edge = 0.1) {
  return with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, edge, 1), 2);
}

inline modal::Modes modes_of(const mesh::TetMesh& mesh, Eigen::Index flexible) {
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

inline fem::ModesSummary summary_of(const modal::Modes& modes) {
  fem::ModesSummary summary;
  summary.residual = Eigen::VectorXd::Constant(modes.mode_count(), 3e-11);
  summary.complete = true;
  summary.text = "modes below 2000 Hz: 34 found, 34 counted";
  summary.clusters = {{9, 2}, {12, 3}};
  return summary;
}

// Two responses over 200 lines with a band, and their errors.
inline Curves curves_of_two() {
  Curves curves;
  curves.name = "responses";
  curves.chooser = "response";
  curves.axis = {.label = "frequency [Hz]"};
  curves.x = {Eigen::VectorXd::LinSpaced(200, 20.0, 900.0)};
  curves.panes.resize(2);
  curves.panes[0].axis = {.label = "receptance [m/N]", .logarithmic = true};
  curves.panes[0].series = {{"95 % band", PlotSeries::Style::band, 6},
                            {"measured", PlotSeries::Style::dots, 1},
                            {"simulated", PlotSeries::Style::line, 2}};
  curves.panes[1].axis = {.label = "phase [deg]", .low = -180.0, .high = 180.0};
  curves.panes[1].series = {{"simulated", PlotSeries::Style::line, 2}};
  curves.panes[1].coarse = true;
  for (const double peak : {300.0, 500.0}) {
    const Eigen::VectorXd size =
        1e-6 / ((curves.x[0].array() / peak).square() - 1.0).abs().cwiseMax(0.02);
    const Eigen::VectorXd phase = 170.0 * (curves.x[0].array() / 100.0).sin();
    curves.choices.push_back({"response at " + std::to_string(static_cast<int>(peak)),
                              {0.9 * size, 1.1 * size, size, 1.3 * size, phase}});
  }
  return curves;
}

inline MatrixPicture likeness() {
  return {.title = "likeness",
          .row_label = "simulated",
          .column_label = "measured",
          .rows = {"100 Hz", "200 Hz"},
          .columns = {"101 Hz", "202 Hz", "303 Hz"},
          .value = (Eigen::MatrixXd(2, 3) << 1.0, 0.25, 0.0, 0.5, NAN, 0.96).finished()};
}

// The verdict of `name`, with its place, before `rest`.
inline Report with_verdict(Report rest, const std::string& name) {
  const Card card{.tone = Note::Tone::good,
                  .heading = "Named: " + name,
                  .lines = {name},
                  .figures = {{"2.83 %", "before"}, {"1 %", "after"}},
                  .next = {"look at " + name}};
  rest.sections.insert(rest.sections.begin(),
                       {Section{"Verdict", {Beside{{card, Place{{name}}}}}},
                        Section{"Evidence",
                                {curves_of_two(), likeness(), Listing{name, name},
                                 Facts{"",
                                       {{"sha256_of_a_file_with_a_name_that_has_no_blank.csv.gz",
                                         std::string(64, 'f')}}}}}});
  return rest;
}

inline Report report_of(Eigen::Index flexible, const std::string& name) {
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

}  // namespace chladni::io
