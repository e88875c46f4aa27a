// chladni check STUDY: what the study says in SI, and what it would cost; runs nothing heavy.
#include "app/solution.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const auto [outline, body, warnings] = introduced(study, run);
  const Places places = places_of(study, outline.shell);
  for (const auto& note : places.notes) run.talk().note(note);
  static_cast<void>(materials_of(study, outline.shell.region_names));
  const Cost cost = forecast(study, outline);
  run.show(cost.line() + "\n");
  run.leave("study.json", study_json(study, body, cost, warnings), !run.options().expect);
  if (run.options().expect) judge(study, solved(study, run), run);
}

}  // namespace

constinit const Command check_command{
    .name = "check",
    .summary = "the study resolved in SI, and an estimate of size, memory and time",
    .run = run,
};

}  // namespace chladni::app
