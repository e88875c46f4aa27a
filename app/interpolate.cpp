// chladni interpolate STUDY: all mode shapes on the whole body, from a few measured points.
#include "app/command.h"
#include "show/identification.h"
#include "show/interpolation.h"
#include "steps/checked.h"
#include "steps/interpolation.h"

namespace chladni::app {
namespace {

void run_interpolate(const study::Study& study, show::Run& run) {
  steps::require_measured(study);
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
