// A small plate and fields of displacement on it.
#pragma once

#include <functional>

#include "mesh/bodies.h"
#include "mesh/site.h"

namespace chladni::fem {

/// The displacement at a place.
using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

inline mesh::TetMesh plate(int order = 2, double edge_length = 0.05) {
  return mesh::with_order(
      mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.04}, edge_length, 1),
      order);
}

inline mesh::Site site_on(const mesh::TetMesh& body, double x, double y) {
  return mesh::SiteFinder(body).from_above(x, y).value();
}

}  // namespace chladni::fem
