// chladni compare STUDY: what was measured beside the simulation, without a search for causes.
#include "app/command.h"
#include "base/error.h"
#include "show/compared.h"

namespace chladni::app {
namespace {

void run_compare(const study::Study& study, show::Run& run) {
  require(study.measurement.has_value(),
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf, time or "
              "modes");
  const auto compared = steps::compared(study, run);
  const auto modes = compared.modes ? steps::modes_beside(study, compared, run)
                                    : std::vector<diagnosis::ModeTold>{};
  run.show(show::compared_text(compared, modes, run.options().all));
  show::leave_compared(compared, modes, run);
}

}  // namespace

constinit const Command compare_command{
    .name = "compare",
    .summary = "measured against simulated: modes, errors of each response; no causes",
    .run = run_compare,
};

}  // namespace chladni::app
