// What a parser promises of a body it hands out, whatever the bytes were.
#pragma once

#include <algorithm>

#include "mesh/surface.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

inline bool indexes(const Cells& cells, Eigen::Index count) {
  return cells.size() == 0 || (cells.minCoeff() >= 0 && cells.maxCoeff() < count);
}

inline bool indexes(const Eigen::VectorXi& numbers, std::size_t count) {
  return numbers.size() == 0 ||
         (numbers.minCoeff() >= 0 && static_cast<std::size_t>(numbers.maxCoeff()) < count);
}

[[nodiscard]] inline bool is_sound(const mesh::Surface& body) {
  return body.points.allFinite() && body.triangles.rows() > 0 && body.triangles.cols() == 3 &&
         indexes(body.triangles, body.points.rows()) &&
         body.patch.size() == body.triangles.rows() && indexes(body.patch, body.patch_names.size());
}

/// What readers promise: cells of positive volume by their corners. Whether curved ones are turned
/// inside out between their corners is for mesh::check.
[[nodiscard]] inline bool is_sound(const mesh::TetMesh& body) {
  mesh::TetMesh by_corners = body;
  by_corners.tets = body.tets.leftCols(std::min<Eigen::Index>(4, body.tets.cols()));
  return body.points.allFinite() && body.tets.rows() > 0 &&
         body.tets.cols() == mesh::tet_nodes(body.order()) && body.faces.rows() > 0 &&
         indexes(body.tets, body.points.rows()) && indexes(body.faces, body.points.rows()) &&
         body.faces.cols() == mesh::face_nodes(body.order()) &&
         body.region.size() == body.tets.rows() && indexes(body.region, body.region_names.size()) &&
         body.face_patch.size() == body.faces.rows() &&
         indexes(body.face_patch, body.patch_names.size()) && mesh::volume(by_corners) > 0.0;
}

}  // namespace chladni::io
