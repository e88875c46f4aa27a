// chladni diagnose STUDY: errors of the simulation, their causes, the extended study, the gain.
#include "app/command.h"
#include "show/diagnosis.h"
#include "show/specimens.h"
#include "steps/diagnosis.h"
#include "steps/specimens.h"

namespace chladni::app {
namespace {

void run_specimens(const study::Study& study, show::Run& run) {
  const auto found = steps::diagnosed_specimens(study, run);
  run.show(show::specimens_table(found.result));
  show::leave_specimens(found, run);
}

void run_diagnose(const study::Study& study, show::Run& run) {
  if (!study.specimens.empty()) return run_specimens(study, run);
  const steps::Diagnosed result = steps::diagnosed(study, run);
  run.show(show::diagnosis_table(result, run.options().all));
  show::leave_diagnosis(study, result, run, true);
}

}  // namespace

constinit const Command diagnose_command{
    .name = "diagnose",
    .summary = "what the simulation gets wrong, its cause, the extended study, the gain",
    .run = run_diagnose,
};

}  // namespace chladni::app
