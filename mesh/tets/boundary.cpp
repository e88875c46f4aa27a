// Finds the faces that belong to only one tetrahedron.
#include <fmt/format.h>

#include <vector>

#include "base/error.h"
#include "mesh/numbering.h"
#include "mesh/tet_mesh.h"

namespace chladni::mesh {

void find_boundary(TetMesh& mesh) {
  const auto n = static_cast<std::int32_t>(mesh.points.rows());
  std::vector<Key> keys;
  keys.reserve(static_cast<std::size_t>(4 * mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const auto tet = mesh.tets.row(t);
    require(tet.minCoeff() >= 0 && tet.maxCoeff() < n, "tetrahedron " + fmt::to_string(t) +
                                                           " names points outside 0 ... " +
                                                           fmt::to_string(n - 1));
    for (const auto& [a, b, c] : kTetFaces) keys.push_back(face_key(tet(a), tet(b), tet(c)));
  }
  const Numbering shared = shared_numbers(keys, n);
  std::vector<std::int32_t> alone;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto uses = shared.uses[static_cast<std::size_t>(shared.number[i])];
    require(uses <= 2, "tetrahedron " + fmt::to_string(i / 4) + ": its face between points " +
                           fmt::to_string(keys[i][0]) + ", " + fmt::to_string(keys[i][1]) + ", " +
                           fmt::to_string(keys[i][2]) + " belongs to " + fmt::to_string(uses) +
                           " tetrahedra, expected at most 2");
    if (uses == 1) alone.push_back(static_cast<std::int32_t>(i));
  }
  const Eigen::MatrixXi local = tet_face_nodes(mesh.order());
  mesh.faces.resize(static_cast<Eigen::Index>(alone.size()), local.cols());
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const std::int32_t i = alone[static_cast<std::size_t>(f)];
    for (Eigen::Index a = 0; a < local.cols(); ++a) {
      mesh.faces(f, a) = mesh.tets(i / 4, local(i % 4, a));
    }
  }
  mesh.face_patch = Eigen::VectorXi::Zero(mesh.faces.rows());
  mesh.patch_names = {"boundary"};
}

}  // namespace chladni::mesh
