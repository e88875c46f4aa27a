// chladni diagnose STUDY: what the simulation gets wrong, its cause, the extended study, the gain.
#include "app/diagnosis.h"
#include "app/diagnosis_structure.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const Solution solution = solved(with_modes_for_diagnosis(study), run);
  const Diagnosed result = diagnosed(study, solution, run);
  run.show(diagnosis_table(result));
  leave_diagnosis(study, solution, result, run, true);
}

}  // namespace

constinit const Command diagnose_command{
    .name = "diagnose",
    .summary = "what the simulation gets wrong, its cause, the extended study, the gain",
    .run = run,
};

}  // namespace chladni::app
