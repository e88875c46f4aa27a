// chladni experiment STUDY: what to play or where to hit, and what it will tell.
#include "show/experiment.h"

#include <algorithm>
#include <utility>

#include "app/command.h"
#include "io/writable.h"
#include "steps/designed.h"

namespace chladni::app {
namespace {

// Refuses names of actuators that the table of signals cannot hold before anything is solved.
void refuse_names_of_signals(const study::Study& study) {
  if (study.design->kind == "hammer" || std::ranges::count(study.design->files, "csv") == 0) return;
  recordings::TimeData data;
  for (const auto& actuator : study.actuators) data.inputs.emplace_back().name = actuator.name;
  io::require_writable_time("excitation.csv", std::move(data));
}

void run_experiment(const study::Study& study, show::Run& run) {
  steps::require_design(study);
  refuse_names_of_signals(study);
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
