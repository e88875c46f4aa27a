// chladni compare STUDY: what was measured beside the simulation, without a search for causes.
#include "app/command.h"
#include "show/compared.h"

namespace chladni::app {
namespace {

void run_compare(const study::Study& study, show::Run& run) {
  const auto comparison = steps::compared(study, run);
  run.show(show::compared_text(comparison, run.options().all));
  show::leave_compared(comparison, run);
}

}  // namespace

constinit const Command compare_command{
    .name = "compare",
    .summary = "measured against simulated: modes, errors of each response; no causes",
    .run = run_compare,
};

}  // namespace chladni::app
