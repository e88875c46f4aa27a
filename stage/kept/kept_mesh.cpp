#include "stage/kept/kept_mesh.h"

#include <optional>

#include "base/error.h"
#include "base/packed.h"
#include "base/sha256.h"
#include "host/loaded_code.h"
#include "host/worker.h"
#include "stage/kept/kept_content.h"

namespace chladni::stage {
namespace {

std::string name_of(const mesh::Surface& surface, const mesh::MesherOptions& options) {
  Packed all;
  all.add("mesh").add(loaded_code()).add(sha256_of_file(worker_path("chladni-tetgen")));
  all.add(surface.points).add(surface.triangles).add(surface.patch).add(surface.patch_names);
  for (const auto& region : surface.regions) all.add(region.name).add(region.inside);
  all.add(options.edge_length).add(options.largest_radius_edge);
  all.add(options.smallest_dihedral_degrees).add(options.remesh_surface);
  return "mesh-" + sha256(all.bytes()).substr(0, 40);
}

std::string bytes_of(const mesh::TetMesh& mesh) {
  Packed to;
  to.add(mesh.points).add(mesh.tets).add(mesh.region).add(mesh.faces).add(mesh.face_patch);
  return to.add(mesh.patch_names).add(mesh.region_names).bytes();
}

mesh::TetMesh mesh_of_bytes(std::string_view bytes) {
  Unpacked from(bytes);
  mesh::TetMesh mesh;
  mesh.points = from.array<Points>();
  mesh.tets = from.array<Cells>();
  mesh.region = from.array<Eigen::VectorXi>();
  mesh.faces = from.array<Cells>();
  mesh.face_patch = from.array<Eigen::VectorXi>();
  mesh.patch_names = from.texts();
  mesh.region_names = from.texts();
  require(from.is_at_end(), "kept mesh: there are bytes after its end");
  check(mesh);
  return mesh;
}

std::optional<mesh::TetMesh> known(const Cache& cache, const std::string& name, Work& work) {
  auto mesh = kept_content(cache, name, mesh_of_bytes);
  if (mesh) work.note("mesh of an earlier run");
  return mesh;
}

}  // namespace

mesh::TetMesh kept_mesh(const mesh::Surface& surface, mesh::MesherOptions options, Work& work) {
  bool died = false;
  options.on_death = [&](const std::string& why) {
    died = true;
    work.note("one of two attempts to mesh the body failed, and the mesh of the other is taken: " +
              why);
  };
  const auto cache = work.choices().cache;
  if (!cache) return tetrahedralize(surface, options, work.progress());
  const auto name = name_of(surface, options);
  if (auto mesh = known(*cache, name, work)) return std::move(*mesh);
  const Cache::Hold hold(*cache, name, work.progress());
  if (auto mesh = known(*cache, name, work)) return std::move(*mesh);
  auto mesh = tetrahedralize(surface, options, work.progress());
  if (died) return mesh;  // on a machine with less to do it may be another
  const auto refused = cache->keep(name, bytes_of(mesh));
  if (!refused.empty()) work.note_once("the mesh is not kept for later runs: " + refused);
  return mesh;
}

}  // namespace chladni::stage
