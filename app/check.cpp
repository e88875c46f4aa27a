// chladni check STUDY: what the study says in SI, and what it would cost; runs nothing heavy.
#include "app/solution.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  auto introduction = introduced(study, run);
  const auto& shell = introduction.outline.shell;
  const auto places = places_of(study, shell);
  for (const auto& note : places.notes) run.talk().note(note);
  for (const auto& warning : places.warnings) {
    introduction.warnings.push_back(warning);
    run.talk().warn(warning);
  }
  static_cast<void>(materials_of(study, shell.region_names));
  run.show(introduction.cost.line() + "\n");
  run.leave("study.json", study_json(study, introduction), !run.options().expect);
  if (run.options().expect) judge(study, solved(study, std::move(introduction), run), run);
}

}  // namespace

constinit const Command check_command{
    .name = "check",
    .summary = "the study resolved in SI, and an estimate of size, memory and time",
    .run = run,
};

}  // namespace chladni::app
