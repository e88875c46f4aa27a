// chladni mesh STUDY: checks the body's surface and fills it with tetrahedra.
#include "app/command.h"
#include "show/solution.h"
#include "stage/body.h"

namespace chladni::app {
namespace {

void run(const Study& study, Run& run) {
  const Outline outline = introduced(study, run).outline;
  const auto body = run.timed("mesh", [&] { return body_of(study, outline, run.progress()); });
  run.show(mesh_text(body));
  leave_mesh(body, run, true);
  paint_patches(study, body, run);
}

}  // namespace

constinit const Command mesh_command{
    .name = "mesh",
    .summary = "surface checks and repair, tetrahedra and their quality",
    .run = run,
};

}  // namespace chladni::app
