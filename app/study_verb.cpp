// chladni study STUDY: every step for which the study has the data.
#include <filesystem>
#include <optional>

#include "app/report.h"

namespace chladni::app {
namespace {

// `simulate` may yet have to write the responses.
bool is_there(const MeasurementPlan& plan) {
  const auto missing = [](const auto& path) {
    return !path.empty() && !std::filesystem::exists(path);
  };
  return has_shapes(plan) && !missing(plan.frf) && !missing(plan.time);
}

void run(const Study& study, Run& run) {
  const Solution solution = solved(study, run);
  run.show(modes_table(solution));
  leave_mesh(solution.model.body, run, false);
  leave_modes(study, solution, run);
  std::optional<Placed> placement;
  if (study.placement) {
    placement = placed(study, solution, run);
    run.show("\n" + placement_table(solution, *placement));
    leave_placement(study, solution, *placement, run, false);
  }
  std::optional<Interpolated> shapes;
  const bool measured = study.measurement && is_there(*study.measurement);
  if (measured && (study.interpolation || !study.diagnosis)) {
    shapes = interpolated(study, solution, run);
    run.show("\n" + interpolation_table(*shapes));
    leave_interpolation(study, solution, *shapes, run, false);
  }
  std::optional<Diagnosed> diagnosis;
  if (measured && study.diagnosis) {
    diagnosis = diagnosed(study, run);
    run.show("\n" + diagnosis_table(*diagnosis));
    leave_diagnosis(study, *diagnosis, run, false);
  }
  leave_report(study, solution,
               {placement ? &*placement : nullptr, shapes ? &*shapes : nullptr,
                diagnosis ? &*diagnosis : nullptr},
               run);
  if (!study.expectations.empty()) judge(study, solution, run);
}

}  // namespace

constinit const Command study_command{
    .name = "study",
    .summary = "every step for which the study has the data, then the report",
    .run = run,
};

}  // namespace chladni::app
