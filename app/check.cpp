// chladni check STUDY: prints the study in SI units and the expected cost. Without --expect it
// solves nothing.
#include <string>

#include "app/command.h"
#include "base/error.h"
#include "show/solution.h"
#include "stage/solution.h"
#include "steps/checked.h"
#include "steps/expectations.h"

namespace chladni::app {
namespace {

// Options that say what a file of measured data does not.
void refuse_options_of_data(const show::Options& options) {
  const std::string of_data = " is of a file of measured data, and this is a study";
  require(options.unit.empty(), "--unit" + of_data + ", where [identification] unit states it");
  require(options.sample_time_s == 0.0, "--sample-time" + of_data);
}

void run_check(const study::Study& study, show::Run& run) {
  refuse_options_of_data(run.options());
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
