// The bodies of the tables against peers: aluminium, ten-node tetrahedra.
#pragma once

#include <string>

#include "base/error.h"
#include "fem/assemble.h"
#include "mesh/bodies.h"
#include "mesh/tetrahedralize.h"

namespace chladni::bench {

struct BenchBody {
  std::string kind = "plate";  ///< "plate": two layers of bricks; "cube"; "meshed": TetGen's plate
  int bricks = 0;              ///< each way along 0.6 m; of a meshed one edges of 0.6 m / bricks
};

inline mesh::TetMesh mesh_of(const BenchBody& body) {
  const double edge = 0.6 / body.bricks;
  const mesh::Plate plate{0.6, 0.6, 0.02};
  if (body.kind == "plate") return mesh::with_order(mesh::layered(plate, edge, 2), 2);
  if (body.kind == "cube") {
    return mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.6}, edge, body.bricks), 2);
  }
  require(body.kind == "meshed", "no body \"" + body.kind + "\"; expected plate, cube or meshed");
  return mesh::with_order(mesh::tetrahedralize(mesh::surface(plate), {.edge_length = edge}), 2);
}

inline fem::System system_of(const mesh::TetMesh& mesh) {
  return fem::assemble(mesh, {fem::isotropic(70e9, 0.33, 2700.0)});
}

}  // namespace chladni::bench
