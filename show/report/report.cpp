// report.html: all present results on one page.
#include "show/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "base/percent.h"
#include "dense/blas.h"
#include "host/parallel.h"
#include "io/report.h"
#include "io/report_sections.h"
#include "show/diagnosis.h"
#include "show/diagnosis/verdict_card.h"
#include "show/identification.h"
#include "show/identification/response_curves.h"
#include "show/interpolation.h"
#include "show/placement.h"
#include "show/version.h"

namespace chladni::show {
namespace {

io::Section channels_of(const study::Study& study, const stage::Solution& solution) {
  auto markers = stage::markers_of(study, solution.model);
  markers.resize(study.sensors.size() + study.actuators.size());
  const auto& modes = solution.modes;
  Eigen::MatrixXd shapes(static_cast<Eigen::Index>(markers.size()), modes.mode_count());
  shapes << stage::shapes_at(study.sensors, solution.model.sensors, modes),
      stage::shapes_at(study.actuators, solution.model.actuators, modes);
  return io::channels_section(markers, modes, shapes);
}

io::Table report_layouts(const steps::BestPlaces& placement) {
  io::Table table{"Layouts", {{"criterion", false}, {"better", false}}, {}};
  for (const auto& layout : placement.layouts) table.columns.push_back({layout.name});
  const auto criteria = placement::layout_criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    const auto& criterion = *criteria[c];
    const std::string unit = criterion.unit == "1" ? "" : " [" + std::string(criterion.unit) + "]";
    io::Table::Row row{
        {std::string(criterion.name) + unit, criterion.larger_is_better ? "more" : "less"}};
    for (const auto& layout : placement.layouts) {
      const double value = layout.scores(static_cast<Eigen::Index>(c));
      row.cells.push_back(std::isfinite(value) ? fmt::format("{:.4g}", value) : "\u2013");
    }
    table.rows.push_back(row);
  }
  return table;
}

io::Section placement_section(const stage::Solution& solution, const steps::BestPlaces& placement,
                              const Run& run) {
  io::Section section{"Placement", {}};
  if (run.has_painted("heat_map.png")) {
    const auto picture = io::picture_section("", run / "heat_map.png",
                                             std::string(placement.criterion->summary) + ".");
    section.blocks = picture.blocks;
  }
  section.blocks.emplace_back(io::report_table(pairs_table(solution, placement, placement.best)));
  if (!placement.layouts.empty()) section.blocks.emplace_back(report_layouts(placement));
  if (run.has_painted("layouts.png")) {
    const auto picture = io::picture_section(
        "", run / "layouts.png", "Where shapes interpolated from each layout will be wrong.");
    section.blocks.insert(section.blocks.end(), picture.blocks.begin(), picture.blocks.end());
  }
  if (run.has_painted("observer_layouts.png")) {
    const auto picture =
        io::picture_section("", run / "observer_layouts.png",
                            "What the observer of each layout will not know of the motion.");
    section.blocks.insert(section.blocks.end(), picture.blocks.begin(), picture.blocks.end());
  }
  for (const auto& optimum : placement.optima) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, optimum_text(optimum)});
  }
  for (const auto& layout : placement.layouts) {
    if (layout.blind.empty()) continue;
    section.blocks.emplace_back(
        io::Note{io::Note::Tone::warning, blind_text(solution, layout) + "."});
  }
  return section;
}

io::Table methods_table(const steps::Interpolated& shapes) {
  const bool has_truth = shapes.measured.truth.size() > 0;
  const bool has_hidden = !shapes.measured.hidden_channels.empty();
  io::Table table{"Ways to interpolate", {{"method", false}}, {}};
  if (has_truth) {
    table.columns.push_back({"squared error [%]"});
    table.columns.push_back({"95 % band covers [%]"});
  }
  if (has_hidden) {
    table.columns.push_back({"held-out shapes, error [%]"});
    table.columns.push_back({"held-out FRFs, error [%]"});
  }
  for (const auto& shape : shapes.methods) {
    io::Table::Row row{{shape.method->name}};
    if (has_truth) {
      row.cells.push_back(percent_cell(shape.error.mean()));
      row.cells.push_back(percent_cell(shape.covered.mean()));
    }
    if (has_hidden) {
      row.cells.push_back(percent_cell(shape.hidden_error.mean()));
      row.cells.push_back(percent_cell(shape.hidden_frf_error.mean()));
    }
    table.rows.push_back(row);
  }
  return table;
}

io::Section identification_section(const steps::IdentifiedModel& model) {
  io::Section section{"Modal model of the measured responses", {}};
  auto curves = fitted_curves(model);
  curves.name = "fit";
  curves.caption =
      "Measured responses and the fit of the modal model. Drag over a range to zoom, "
      "double-click for all of it. " +
      curves.caption;
  section.blocks.emplace_back(std::move(curves));
  section.blocks.emplace_back(io::report_table(identified_modes_table(model)));
  if (const auto quality = quality_table(model)) {
    section.blocks.emplace_back(io::Note{
        io::Note::Tone::plain, "The recordings: " + model.measured.quality->verdict + "."});
    section.blocks.emplace_back(io::report_table(*quality));
  }
  section.blocks.emplace_back(
      io::Note{io::Note::Tone::plain,
               fmt::format("The responses are fitted to {} % of their size; {}.",
                           percent_cell(steps::overall_error(model)), noise_text(model))});
  if (const auto unseen = unseen_text(model); !unseen.empty()) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::plain, "Not seen by the fit: " + unseen});
  }
  if (!model.stabilisation.empty()) {
    const auto plot = stabilisation_plot(model);
    auto poles = curves_of(plot, "stabilisation", "diagram");
    poles.caption = "Stabilisation: poles of rising order. Dashed: the modes of the fit.";
    section.blocks.emplace_back(std::move(poles));
  }
  for (const auto& warning : model.match.warnings) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::warning, warning + "."});
  }
  return section;
}

io::Section shapes_section(const study::Study& study, const steps::Interpolated& shapes,
                           const Run& run) {
  io::Section section{"Shapes between the sensors", {}};
  const auto& shown = shapes.methods.front();
  if (run.has_painted("mode_field.png")) {
    const auto picture = io::picture_section(
        "", run / "mode_field.png",
        std::string("How well each shape is known: ") + shown.method->summary + ".");
    section.blocks = picture.blocks;
  }
  const auto responses =
      predictions_picture(study.interpolation.value_or(study::InterpolationPlan{}).predicted);
  if (run.has_painted(responses)) {
    const auto more = io::picture_section(
        "", run / responses,
        "Responses at the sensors that no fit saw and at the points of interest.");
    section.blocks.insert(section.blocks.end(), more.blocks.begin(), more.blocks.end());
  }
  section.blocks.emplace_back(methods_table(shapes));
  for (const auto& note : shown.field->summary().notes) {
    section.blocks.emplace_back(io::Note{io::Note::Tone::warning, note + "."});
  }
  return section;
}

// "isotropic: youngs_modulus 7e+10, poissons_ratio 0.33, density 2700 (SI)".
std::string material_text(const study::StudyMaterial& material) {
  std::string text = (material.region.empty() ? "" : material.region + ", ") + material.symmetry;
  const char* before = ": ";
  for (const auto& [name, value] : material.constants) {
    text += fmt::format("{}{} {:.6g}", before, name, value);
    before = ", ";
  }
  return text + " (SI)";
}

// Date of the report, in UTC: SOURCE_DATE_EPOCH if that is set, so that the file is reproducible
// (reproducible-builds.org/specs/source-date-epoch).
std::string date_text() {
  std::time_t seconds = std::time(nullptr);
  if (const char* stated = std::getenv("SOURCE_DATE_EPOCH"); stated != nullptr) {
    const std::string_view text = stated;
    static_cast<void>(std::from_chars(text.data(), text.data() + text.size(), seconds));
    constexpr std::time_t kEndOf9999 = 253402300799;  // [s] later years have no such text
    seconds = std::clamp<std::time_t>(seconds, 0, kEndOf9999);
  }
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(seconds));
}

io::Section provenance_of(const study::Study& study, Run& run) {
  std::vector<std::pair<std::string, std::string>> lines = {{"chladni", version()},
                                                            {"study", study.title}};
  if (!run.options().reproducible) lines.emplace_back("date", date_text());
  for (const auto& material : study.materials) {
    lines.emplace_back("material", material_text(material));
  }
  const study::Origin origin = run.origin(true);
  lines.emplace_back("sha256 of the study", origin.study);
  for (const auto& [file, digits] : origin.inputs) lines.emplace_back("sha256 of " + file, digits);
  lines.insert(lines.end(), {{"BLAS kernel", dense::blas_kernel()},
                             {"threads", fmt::to_string(thread_count())},
                             {"seed", fmt::to_string(run.seed())}});
  for (const auto& [step, time] : run.seconds()) {
    lines.emplace_back("seconds, " + step, fmt::format("{:.2f}", time));
  }
  io::Section section = io::provenance_section(lines);
  section.blocks.emplace_back(io::Listing{"The study, with all its settings", study.text});
  return section;
}

// True if flat faces bound the body. A mesh of a round body or of a file may be a little too small.
bool is_filled_exactly(const study::Geometry& geometry) {
  if (const auto* table = std::get_if<mesh::WaferTable>(&geometry.body)) {
    return table->bores.empty() && !(table->wafer_diameter > 0.0);
  }
  return std::holds_alternative<mesh::Plate>(geometry.body) ||
         std::holds_alternative<mesh::Quadrilateral>(geometry.body);
}

// The verdict beside the body, on which its places are marked.
io::Section verdict_section(const steps::Diagnosed& diagnosis) {
  io::Section section{"Verdict", {verdict_card(diagnosis)}};
  auto marked = marked_names(diagnosis);
  if (marked.empty()) return section;
  io::Beside beside{std::move(section.blocks)};
  beside.blocks.emplace_back(io::Place{std::move(marked)});
  section.blocks = {std::move(beside)};
  return section;
}

io::Section section_of_modes(const study::Study& study, const stage::Solution& solution,
                             const steps::Diagnosed* diagnosis) {
  auto markers = stage::markers_of(study, solution.model);
  if (diagnosis != nullptr) {
    const auto causes = cause_markers(*diagnosis);
    markers.insert(markers.end(), causes.begin(), causes.end());
  }
  return io::modes_section(solution.model.body, solution.modes, solution.summary,
                           solution.frequency_error, markers, is_filled_exactly(study.geometry));
}

void add_results(io::Report& report, const study::Study& study, const stage::Solution& solution,
                 const Found& found, const Run& run) {
  if (found.diagnosis != nullptr) {
    report.sections.push_back(verdict_section(*found.diagnosis));
    report.sections.push_back(diagnosis_section(*found.diagnosis, &run));
  }
  if (found.placement != nullptr) {
    report.sections.push_back(placement_section(solution, *found.placement, run));
  }
  if (found.shapes != nullptr && found.shapes->measured.identified) {
    report.sections.push_back(identification_section(*found.shapes->measured.identified));
  }
  if (found.shapes != nullptr) report.sections.push_back(shapes_section(study, *found.shapes, run));
}

// The picture of the modes where the page stays small with it; else the printer gets the shapes of
// the viewer.
void add_modes_picture(io::Report& report, std::size_t behind, const Run& run) {
  constexpr std::size_t most_bytes = 1'000'000;
  if (run.has_painted("modes.png")) {
    auto with_picture = report;
    with_picture.sections.insert(
        with_picture.sections.begin() + static_cast<std::ptrdiff_t>(behind),
        io::picture_section("The first flexible modes", run / "modes.png",
                            "Nodal lines are black."));
    if (io::html(with_picture).size() < most_bytes) {
      report = std::move(with_picture);
      return;
    }
  }
  for (auto& block : report.sections[behind - 1].blocks) {
    auto* beside = std::get_if<io::Beside>(&block);
    if (beside == nullptr) continue;
    for (auto& part : beside->blocks) {
      if (auto* viewer = std::get_if<io::Viewer>(&part)) viewer->on_paper = 9;
    }
  }
}

}  // namespace

std::string modes_page(const study::Study& study, const stage::Solution& solution) {
  io::Report report{
      study.title, solution.introduction.body.line(), solution.introduction.warnings, {}};
  report.sections.push_back(section_of_modes(study, solution, nullptr));
  return io::html(report);
}

std::string diagnosis_page(const study::Study& study, const steps::Diagnosed& diagnosis) {
  const auto& solution = diagnosis.before;
  io::Report report{
      study.title, solution.introduction.body.line(), solution.introduction.warnings, {}};
  report.sections = {verdict_section(diagnosis), diagnosis_section(diagnosis, nullptr),
                     section_of_modes(study, solution, &diagnosis)};
  return io::html(report);
}

void leave_report(const study::Study& study, const stage::Solution& solution, const Found& found,
                  Run& run) {
  run.finish_pictures();
  const auto& model = solution.model;
  io::Report report;
  report.title = study.title;
  report.understood = solution.introduction.body.line();
  report.warnings = solution.introduction.warnings;
  add_results(report, study, solution, found, run);
  report.sections.push_back(section_of_modes(study, solution, found.diagnosis));
  const auto behind_modes = report.sections.size();
  report.sections.push_back(io::body_section(model.mass, model.body, mesh::quality(model.body),
                                             solution.degrees_of_freedom));
  if (run.has_painted("mesh.png")) {
    report.sections.push_back(io::picture_section(
        "Patches", run / "mesh.png",
        "Names that `on`, `keep_out` and supports may take; on = { facing = \"z\" } needs none."));
  }
  if (!study.sensors.empty() || !study.actuators.empty()) {
    report.sections.push_back(channels_of(study, solution));
  }
  report.sections.push_back(provenance_of(study, run));
  add_modes_picture(report, behind_modes, run);
  io::write_report(run / "report.html", report);
}

}  // namespace chladni::show
