// chladni mesh STUDY: checks the body's surface and fills it with tetrahedra.
#include "app/command.h"
#include "show/solution.h"
#include "stage/body.h"

namespace chladni::app {
namespace {

void run_mesh(const study::Study& study, show::Run& run) {
  const stage::Outline outline = stage::introduced(study, run).outline;
  const auto body = run.timed("mesh", [&] { return stage::body_of(study, outline, run); });
  run.show(show::mesh_text(body));
  show::leave_mesh(body, run, true);
  show::paint_patches(study, body, run);
}

}  // namespace

constinit const Command mesh_command{
    .name = "mesh",
    .summary = "surface checks and repair, tetrahedra and their quality",
    .run = run_mesh,
};

}  // namespace chladni::app
