// chladni export STUDY: K and M of the study's body for other programs.
#include "show/export.h"
#include "app/command.h"

namespace chladni::app {
namespace {

void run_export(const study::Study& study, show::Run& run) {
  const auto solution = stage::assembled(study, run);
  run.timed("writing", [&] {
    show::leave_system(study, solution, run);
    return 0;
  });
  run.leave("export.json", show::export_json(solution), true);
  run.show(show::export_text(solution, run));
}

}  // namespace

constinit const Command export_command{
    .name = "export",
    .summary = "K, M, rigid-body modes and channels for other programs",
    .run = run_export,
};

}  // namespace chladni::app
