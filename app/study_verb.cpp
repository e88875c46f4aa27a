// chladni study STUDY: every step for which the study has the data.
#include "app/solution.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const Solution solution = solved(study, run);
  run.show(modes_table(solution));
  leave_mesh(solution.model.body, run, false);
  leave_modes(study, solution, run);
  leave_report(study, solution, run);
  if (!study.expectations.empty()) judge(study, solution, run);
}

}  // namespace

constinit const Command study_command{
    .name = "study",
    .summary = "every step for which the study has the data, then the report",
    .run = run,
};

}  // namespace chladni::app
