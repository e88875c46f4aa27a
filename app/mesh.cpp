// chladni mesh STUDY: checks the body's surface and fills it with tetrahedra.
#include "app/stage/solution.h"
#include "io/patches_picture.h"
#include "io/vtu.h"

namespace chladni::app {

void leave_mesh(const mesh::TetMesh& body, Run& run, bool main_result) {
  io::write_vtu(run / "mesh.vtu", body, {});
  run.leave("mesh.json", mesh_json(body), main_result);
}

void paint_patches(const Study& study, const mesh::TetMesh& body, Run& run) {
  if (run.options().pictures) tell(run.talk().progress(), "painting the patches");
  run.paint("mesh.png", [&](const auto& png) { io::draw_patches(png, body, study.title); });
}

namespace {

void run(const Study& study, Run& run) {
  const Outline outline = introduced(study, run).outline;
  const auto body =
      run.timed("mesh", [&] { return body_of(study, outline, run.talk().progress()); });
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
