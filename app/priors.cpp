// chladni priors STUDY: length scales, amplitudes and noise from the simulated modes.
#include "app/command.h"
#include "show/priors.h"
#include "steps/priors.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const Solution solution = solved(study, run);
  const LearnedPriors result = learned_priors(study, solution, run);
  for (const auto& note : result.notes) run.note(note);
  run.show(priors_table(solution, result));
  run.leave("priors.json", priors_json(solution, result), true);
}

}  // namespace

constinit const Command priors_command{
    .name = "priors",
    .summary = "what the simulated modes teach of length scales, amplitudes and noise",
    .run = run,
};

}  // namespace chladni::app
