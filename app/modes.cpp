// chladni modes STUDY: natural frequencies and mode shapes of the body in the study.
#include "app/command.h"
#include "show/solution.h"

namespace chladni::app {
namespace {

void run_modes(const study::Study& study, show::Run& run) {
  const stage::Solution solution = stage::solved(study, run);
  run.show(show::modes_table(solution));
  show::leave_modes(study, solution, run);
}

}  // namespace

constinit const Command modes_command{
    .name = "modes",
    .summary = "natural frequencies and mode shapes of the body",
    .run = run_modes,
};

}  // namespace chladni::app
