#include "mesh/soundness/inside_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

using Triangle = Eigen::Matrix3d;  // one corner per column

Triangle triangle(const Surface& surface, Eigen::Index t) {
  Triangle corners;
  for (int k = 0; k < 3; ++k) {
    corners.col(k) = surface.points.row(surface.triangles(t, k)).transpose();
  }
  return corners;
}

Eigen::Vector3d doubled_area(const Triangle& t) {
  return (t.col(1) - t.col(0)).cross(t.col(2) - t.col(0));
}

// Distance along the ray to the triangle [m]; infinite where the ray misses it. Moller and
// Trumbore, J. Graphics Tools 2 (1997) 21.
double hit(const Triangle& t, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  constexpr double miss = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d u = t.col(1) - t.col(0);
  const Eigen::Vector3d v = t.col(2) - t.col(0);
  const Eigen::Vector3d p = direction.cross(v);
  const double determinant = u.dot(p);
  if (determinant == 0.0) return miss;
  const Eigen::Vector3d s = from - t.col(0);
  const double a = s.dot(p) / determinant;
  const double b = direction.dot(s.cross(u)) / determinant;
  const double distance = v.dot(s.cross(u)) / determinant;
  const bool inside = a >= 0.0 && b >= 0.0 && a + b <= 1.0 && distance > 0.0;
  return inside ? distance : miss;
}

}  // namespace

Eigen::Vector3d inside_point(const Surface& surface) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(surface.triangles.rows()));
  std::vector<double> size;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    size.push_back(doubled_area(triangle(surface, t)).squaredNorm());
  }
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return size[static_cast<std::size_t>(a)] > size[static_cast<std::size_t>(b)];
  });
  const std::vector<int> all(order.size(), 1);
  for (const Eigen::Index t : order) {
    const Triangle here = triangle(surface, t);
    const Eigen::Vector3d from = here.rowwise().mean();
    const Eigen::Vector3d inward = -doubled_area(here).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index other = 0; other < surface.triangles.rows(); ++other) {
      if (other != t) nearest = std::min(nearest, hit(triangle(surface, other), from, inward));
    }
    const Eigen::Vector3d point = from + 0.5 * nearest * inward;
    if (std::isfinite(nearest) && winding_number(surface, all, point) > 0.5) return point;
  }
  throw InvalidInput("inside_point: the surface has no inside; expected a closed one");
}

}  // namespace chladni::mesh
