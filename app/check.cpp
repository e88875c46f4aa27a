// chladni check STUDY: prints the study in SI units and the expected cost; solves nothing.
#include "app/command.h"
#include "show/solution.h"
#include "stage/solution.h"
#include "steps/checked.h"
#include "steps/expectations.h"

namespace chladni::app {
namespace {

void run_check(const study::Study& study, show::Run& run) {
  auto introduction = steps::checked(study, !run.options().expect, run);
  run.show(introduction.cost.line() + "\n");
  run.leave("study.json", show::study_json(study, introduction), !run.options().expect);
  stage::refuse_what_cannot_fit(study, introduction, run);
  if (run.options().expect)
    steps::judge(study, stage::solved(study, std::move(introduction), run), run);
}

}  // namespace

constinit const Command check_command{
    .name = "check",
    .summary = "the study resolved in SI, and an estimate of size, memory and time",
    .run = run_check,
};

}  // namespace chladni::app
