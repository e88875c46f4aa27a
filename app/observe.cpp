// chladni observe STUDY: the motion where no sensor is, from the sensors there are.
#include "app/command.h"
#include "show/observer.h"
#include "steps/predicted.h"

namespace chladni::app {
namespace {

void run_observe(const study::Study& study, show::Run& run) {
  steps::require_observer(study);
  const stage::Solution solution = stage::solved(study, run);
  const auto observed = steps::observed(study, solution, run);
  run.show(show::observer_table(observed));
  show::leave_observer(study, observed, run);
  steps::require_trust(steps::identified_of(*observed.observer.shapes));
}

}  // namespace

constinit const Command observe_command{
    .name = "observe",
    .summary = "the motion where no sensor is, by a Kalman filter on the identified model",
    .run = run_observe,
};

}  // namespace chladni::app
