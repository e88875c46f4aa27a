// chladni identify STUDY: a modal model from measured responses.
#include "app/command.h"
#include "show/identification.h"
#include "steps/identification.h"

namespace chladni::app {
namespace {

void run_identify(const study::Study& study, show::Run& run) {
  const steps::IdentifiedModel model = steps::identified(study, nullptr, run);
  run.show(show::identification_text(study, model));
  show::leave_identification(study, model, run, true);
  steps::require_trust(model);
}

}  // namespace

constinit const Command identify_command{
    .name = "identify",
    .summary = "a modal model with uncertainties from measured responses",
    .run = run_identify,
};

}  // namespace chladni::app
