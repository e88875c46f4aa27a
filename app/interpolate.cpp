// chladni interpolate STUDY: all mode shapes on the whole body, from a few measured points.
#include "app/command.h"
#include "steps/interpolation.h"

#include <filesystem>

#include "base/error.h"
#include "show/identification.h"
#include "show/interpolation.h"

namespace chladni::app {
namespace {

void require_there(const study::MeasurementPlan& plan) {
  for (const auto& path : {plan.shapes, plan.truth, plan.frf, plan.time}) {
    require(path.empty() || std::filesystem::exists(path),
            path.string() + ": there is no such file" + study::source_text(plan));
  }
}

void run_interpolate(const study::Study& study, show::Run& run) {
  require(study.measurement && steps::has_shapes(*study.measurement),  // before minutes of solving
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf, time, shapes "
              "or truth");
  require_there(*study.measurement);
  const stage::Solution solution = stage::solved(study, run);
  const steps::Interpolated result =
      steps::interpolated(study, solution, run, show::shown_and_left(study, run));
  run.show(show::interpolation_table(result));
  show::leave_interpolation(study, solution, result, run, true);
  if (result.measured.identified) steps::require_trust(*result.measured.identified);
}

}  // namespace

constinit const Command interpolate_command{
    .name = "interpolate",
    .summary = "mode shapes at any point with their uncertainty, from a few measured ones",
    .run = run_interpolate,
};

}  // namespace chladni::app
