#include "mesh/surface.h"

#include <Eigen/Geometry>

namespace chladni::mesh {

double enclosed_volume(const Surface& surface) {
  double six_volumes = 0.0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
    const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1));
    const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2));
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6.0;
}

Eigen::Matrix<double, 2, 3, Eigen::RowMajor> bounding_box(const Points& points) {
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> box;
  box.setZero();
  if (points.rows() == 0) return box;
  box.row(0) = points.colwise().minCoeff();
  box.row(1) = points.colwise().maxCoeff();
  return box;
}

double area(const Points& points, const Cells& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = points.row(triangles(t, 0));
    const Eigen::Vector3d b = points.row(triangles(t, 1));
    const Eigen::Vector3d c = points.row(triangles(t, 2));
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

}  // namespace chladni::mesh
