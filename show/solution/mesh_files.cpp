#include "io/patches_picture.h"
#include "io/vtu.h"
#include "show/solution.h"

namespace chladni::show {

void leave_mesh(const mesh::TetMesh& body, Run& run, bool main_result) {
  io::write_vtu(run / "mesh.vtu", body, {});
  run.leave("mesh.json", mesh_json(body), main_result);
}

void paint_patches(const study::Study& study, const mesh::TetMesh& body, Run& run) {
  if (run.options().pictures) tell(run.progress(), "painting the patches");
  run.paint("mesh.png", [&](const auto& png) { io::draw_patches(png, body, study.title); });
}

}  // namespace chladni::show
