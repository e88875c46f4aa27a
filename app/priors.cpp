// chladni priors STUDY: length scales, amplitudes and noise from the simulated modes.
#include "show/priors.h"
#include "app/command.h"
#include "steps/priors.h"

namespace chladni::app {
namespace {

void run_priors(const study::Study& study, show::Run& run) {
  const stage::Solution solution = stage::solved(study, run);
  const steps::LearnedPriors result = steps::learned_priors(study, solution, run);
  for (const auto& note : result.notes) run.note(note);
  run.show(show::priors_table(solution, result));
  run.leave("priors.json", show::priors_json(solution, result), true);
}

}  // namespace

constinit const Command priors_command{
    .name = "priors",
    .summary = "what the simulated modes teach of length scales, amplitudes and noise",
    .run = run_priors,
};

}  // namespace chladni::app
