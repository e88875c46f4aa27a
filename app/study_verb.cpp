// chladni study STUDY: modes, placement, interpolation and diagnosis in one go, then the report.
#include <filesystem>
#include <optional>

#include "app/command.h"
#include "show/diagnosis.h"
#include "show/identification.h"
#include "show/interpolation.h"
#include "show/placement.h"
#include "show/report.h"
#include "show/solution.h"
#include "stage/diagnosis_structure.h"
#include "steps/expectations.h"
#include "steps/measured_modes.h"

namespace chladni::app {
namespace {

// True if there are measured data. A warning names a missing file: `simulate` must still write it,
// or it does not come with the study.
bool is_there(const study::MeasurementPlan& plan, show::Run& run) {
  for (const auto& path : {plan.frf, plan.time, plan.validation, plan.modes_file, plan.reference}) {
    if (path.empty() || std::filesystem::exists(path)) continue;
    run.warn(path.string() + ": there is no such file; nothing that was measured is used" +
             study::source_text(plan));
    return false;
  }
  return steps::has_shapes(plan) || steps::has_modes(plan);
}

// The study is solved once, also where a diagnosis needs more modes than the study asks for.
stage::TwoSolutions solved(const study::Study& study, bool diagnosed, stage::Work& work) {
  if (diagnosed) return stage::solved_with_more(study, stage::kDiagnosisModes, work);
  return {.own = stage::solved(study, work), .with_more = {}};
}

void run_study(const study::Study& study, show::Run& run) {
  const bool measured = study.measurement && is_there(*study.measurement, run);
  auto [solution, with_more] = solved(study, measured && study.diagnosis, run);
  run.show(show::modes_table(solution));
  show::leave_mesh(solution.model.body, run, false);
  // If the body is given by its dimensions, the names of its patches are known.
  if (study.geometry.kind == "file") show::paint_patches(study, solution.model.body, run);
  show::leave_modes(study, solution, run);
  std::optional<steps::BestPlaces> placement;
  if (study.placement) {
    placement = steps::best_places(study, solution, run);
    run.show("\n" + show::placement_table(solution, *placement, run.options().all));
    show::leave_placement(study, solution, *placement, run, false);
  }
  std::optional<steps::Interpolated> shapes;
  const bool has_shapes = measured && steps::has_shapes(*study.measurement);
  if (has_shapes && (study.interpolation || !study.diagnosis)) {
    shapes = steps::interpolated(study, solution, run, show::shown_and_left(study, run));
    run.show("\n" + show::interpolation_table(*shapes));
    show::leave_interpolation(study, solution, *shapes, run, false);
  }
  std::optional<steps::Diagnosed> diagnosis;
  if (measured && study.diagnosis) {
    diagnosis = steps::diagnosed(study, std::move(with_more), run);
    run.show("\n" + show::diagnosis_table(*diagnosis, run.options().all));
    show::leave_diagnosis(study, *diagnosis, run, false);
  }
  show::leave_report(study, solution,
                     {placement ? &*placement : nullptr, shapes ? &*shapes : nullptr,
                      diagnosis ? &*diagnosis : nullptr},
                     run);
  if (!study.specimens.empty()) run.note("specimens are compared by chladni diagnose alone");
  if (!study.expectations.empty()) steps::judge(study, solution, run);
  if (shapes && shapes->measured.identified) steps::require_trust(*shapes->measured.identified);
}

}  // namespace

constinit const Command study_command{
    .name = "study",
    .summary = "mesh, modes, placement, interpolation, diagnosis: what it has data for; a report",
    .run = run_study,
};

}  // namespace chladni::app
