// chladni identify STUDY: a modal model from measured responses.
#include "app/command.h"
#include "show/identification.h"
#include "steps/identification.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const IdentifiedModel model = identified(study, nullptr, run);
  run.show(identification_table(model));
  leave_identification(study, model, run, true);
  require_trust(model);
}

}  // namespace

constinit const Command identify_command{
    .name = "identify",
    .summary = "a modal model with uncertainties from measured responses",
    .run = run,
};

}  // namespace chladni::app
