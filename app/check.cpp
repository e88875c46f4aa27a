// chladni check STUDY: prints the study in SI units and the expected cost. Without --expect it
// solves nothing.
#include "app/command.h"
#include "show/solution.h"
#include "stage/solution.h"
#include "steps/checked.h"
#include "steps/expectations.h"

namespace chladni::app {
namespace {

void run_check(const study::Study& study, show::Run& run) {
  const bool expect = run.options().expect;
  if (expect) steps::require_expectations(study);
  auto introduction = steps::checked(study, !expect, run);
  run.show(introduction.cost.line() + "\n");
  auto json = show::study_json(study, introduction);
  run.leave("study.json", json, !expect);
  stage::refuse_what_cannot_fit(study, introduction, run);
  if (!expect) return;
  const auto solution = stage::solved(study, std::move(introduction), run);
  const auto judged = steps::judged(study, solution, run);
  show::add_judged(judged, json);
  run.leave("study.json", std::move(json), true);
  steps::require_met(study, judged, solution);
}

}  // namespace

constinit const Command check_command{
    .name = "check",
    .summary = "the study resolved in SI, and an estimate of size, memory and time",
    .run = run_check,
};

}  // namespace chladni::app
