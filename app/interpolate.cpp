// chladni interpolate STUDY: every mode shape everywhere, from a few measured points.
#include "app/interpolation.h"

#include "base/error.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  require(study.measurement && has_shapes(*study.measurement),  // before minutes of solving
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf, time, shapes "
              "or truth");
  const Solution solution = solved(study, run);
  const Interpolated result = interpolated(study, solution, run);
  run.show(interpolation_table(result));
  leave_interpolation(study, solution, result, run, true);
  if (result.measured.identified) require_trust(*result.measured.identified);
}

}  // namespace

constinit const Command interpolate_command{
    .name = "interpolate",
    .summary = "mode shapes at any point with their uncertainty, from a few measured ones",
    .run = run,
};

}  // namespace chladni::app
