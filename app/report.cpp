// report.html: what exists so far, on one page.
#include "io/report.h"

#include <fmt/format.h>

#include "app/solution.h"
#include "base/parallel.h"
#include "fem/blas.h"
#include "io/report_sections.h"

namespace chladni::app {
namespace {

io::Section channels_of(const Study& study, const Solution& solution) {
  auto markers = markers_of(study, solution.model);
  markers.resize(study.sensors.size() + study.actuators.size());
  const auto& modes = solution.modes;
  Eigen::MatrixXd shapes(static_cast<Eigen::Index>(markers.size()), modes.mode_count());
  shapes << shapes_at(study.sensors, solution.model.sensors, modes),
      shapes_at(study.actuators, solution.model.actuators, modes);
  return io::channels_section(markers, modes, shapes);
}

io::Section provenance_of(const Study& study, const Run& run) {
  std::vector<std::pair<std::string, std::string>> lines = {
      {"chladni", CHLADNI_VERSION},
      {"study", study.title},
      {"sha256 of the study", study.sha256},
      {"BLAS kernel", fem::blas_kernel()},
      {"threads", std::to_string(thread_count())},
      {"seed", std::to_string(run.seed())}};
  for (const auto& [step, time] : run.seconds()) {
    lines.emplace_back("seconds, " + step, fmt::format("{:.2f}", time));
  }
  return io::provenance_section(lines);
}

}  // namespace

void leave_report(const Study& study, const Solution& solution, Run& run) {
  const auto& model = solution.model;
  io::Report report;
  report.title = study.title;
  report.understood = solution.introduction.body.line();
  report.warnings = solution.introduction.warnings;
  report.sections.push_back(io::modes_section(model.body, solution.modes, solution.summary,
                                              solution.frequency_error, markers_of(study, model)));
  if (run.options().pictures) {
    report.sections.push_back(io::picture_section("The first flexible modes", run / "modes.png",
                                                  "Nodal lines are black."));
  }
  report.sections.push_back(io::body_section(model.mass, model.body, mesh::quality(model.body),
                                             solution.degrees_of_freedom));
  if (!study.sensors.empty() || !study.actuators.empty()) {
    report.sections.push_back(channels_of(study, solution));
  }
  report.sections.push_back(provenance_of(study, run));
  io::write_report(run / "report.html", report);
}

}  // namespace chladni::app
