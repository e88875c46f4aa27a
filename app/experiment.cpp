// chladni experiment STUDY: what to play or where to hit, and what it will tell.
#include "show/experiment.h"
#include "app/command.h"
#include "steps/designed.h"

namespace chladni::app {
namespace {

void run_experiment(const study::Study& study, show::Run& run) {
  steps::require_design(study);
  const stage::Solution solution = stage::solved(study, run);
  const auto designed = steps::designed(study, solution, run);
  run.show(show::experiment_text(study, designed));
  show::leave_experiment(study, designed, run);
}

}  // namespace

constinit const Command experiment_command{
    .name = "experiment",
    .summary = "signals to play or points to hit, and the expected quality",
    .run = run_experiment,
};

}  // namespace chladni::app
