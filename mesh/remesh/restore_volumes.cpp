#include "mesh/remesh/restore_volumes.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace chladni::mesh {
namespace {

// The area vector of a triangle: twice the area, along the normal.
Eigen::Vector3d area_vector(const Surface& surface, Eigen::Index t) {
  const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
  const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1));
  const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2));
  return (b - a).cross(c - a);
}

// For each part, the volume of the cones from its triangles to the point `tip` [m^3].
Eigen::VectorXd cones(const Surface& surface, Eigen::Index parts, const Eigen::Vector3d& tip) {
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(parts);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
    volume[surface.patch[t]] += area_vector(surface, t).dot(a - tip) / 6.0;
  }
  return volume;
}

// For each point, the part in whose inside it lies; −1 on the rim of a part.
std::vector<int> parts_of_points(const Surface& surface) {
  std::vector<int> part(static_cast<std::size_t>(surface.points.rows()), -2);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (const int i : surface.triangles.row(t)) {
      int& p = part[static_cast<std::size_t>(i)];
      p = p == -2 || p == surface.patch[t] ? surface.patch[t] : -1;
    }
  }
  return part;
}

// For each point, its share of the area around it, along the normal [m^2].
Points area_normals(const Surface& surface) {
  Points normal = Points::Zero(surface.points.rows(), 3);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (const int i : surface.triangles.row(t)) {
      normal.row(i) += area_vector(surface, t).transpose() / 6.0;
    }
  }
  return normal;
}

}  // namespace

void restore_volumes(Surface& after, const Surface& before, const std::vector<double>& most) {
  const auto parts = static_cast<Eigen::Index>(most.size());
  const Eigen::Vector3d tip = bounding_box(before.points).colwise().mean().transpose();
  const Eigen::VectorXd wanted = cones(before, parts, tip);
  const std::vector<int> part = parts_of_points(after);
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd missing = wanted - cones(after, parts, tip);
    const Points normal = area_normals(after);
    Eigen::VectorXd area = Eigen::VectorXd::Zero(parts);
    for (Eigen::Index i = 0; i < normal.rows(); ++i) {
      const int p = part[static_cast<std::size_t>(i)];
      if (p >= 0) area[p] += normal.row(i).norm();
    }
    for (Eigen::Index i = 0; i < normal.rows(); ++i) {
      const int p = part[static_cast<std::size_t>(i)];
      if (p < 0 || area[p] <= 0.0) continue;
      const double limit = most[static_cast<std::size_t>(p)];
      after.points.row(i) +=
          std::clamp(missing[p] / area[p], -limit, limit) * normal.row(i).stableNormalized();
    }
  }
}

}  // namespace chladni::mesh
