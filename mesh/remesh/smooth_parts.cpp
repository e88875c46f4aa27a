#include "mesh/remesh/smooth_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "mesh/disjoint_sets.h"

namespace chladni::mesh {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The area vector of a triangle: twice the area, along the normal.
Eigen::Vector3d area_vector(const Surface& surface, int t) {
  const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
  const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1));
  const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2));
  return (b - a).cross(c - a);
}

// Distances below this may be rounding of coordinates in single precision [m].
double rounding(const Surface& surface) { return 5e-7 * surface.points.cwiseAbs().maxCoeff(); }

// The angle between the normals of the two triangles at an edge [rad].
double turn(const Surface& surface, const EdgeUse& a, const EdgeUse& b) {
  const Eigen::Vector3d u = area_vector(surface, a.triangle);
  const Eigen::Vector3d v =
      (a.forward == b.forward ? -1.0 : 1.0) * area_vector(surface, b.triangle);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// Grows planes from the largest triangles over all connected triangles that lie in the plane.
class Planes {
 public:
  Planes(const Surface& surface, const std::vector<EdgeUse>& uses, double width)
      : surface_(surface), width_(width), tolerance_(rounding(surface)) {
    const auto count = static_cast<std::size_t>(surface.triangles.rows());
    plane_.assign(count, -1);
    neighbours_.resize(count);
    for (std::size_t first = 0; first < uses.size();) {
      const std::size_t end = end_of_edge(uses, first);
      if (end - first == 2) join(uses[first], uses[first + 1]);
      first = end;
    }
  }

  // For each triangle its plane; −1 where no wide enough plane contains it.
  std::vector<int> of_triangles() && {
    std::vector<double> area;
    for (int t = 0; t < static_cast<int>(plane_.size()); ++t) {
      area.push_back(area_vector(surface_, t).norm());
    }
    std::vector<int> order(plane_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return area[static_cast<std::size_t>(a)] > area[static_cast<std::size_t>(b)];
    });
    int count = 0;
    for (const int t : order) {
      if (plane_[static_cast<std::size_t>(t)] != -1) continue;
      const std::vector<int> found = grown_from(t, count);
      const bool wide = is_wide(found, count);
      for (const int i : found) plane_[static_cast<std::size_t>(i)] = wide ? count : -2;
      count += wide ? 1 : 0;
    }
    for (int& p : plane_) p = std::max(p, -1);
    return std::move(plane_);
  }

 private:
  struct Neighbour {
    int triangle, apex;
    double sign;  // −1 where the two triangles have opposite orientations, else 1
    double length;
  };

  void join(const EdgeUse& a, const EdgeUse& b) {
    if (surface_.patch[a.triangle] != surface_.patch[b.triangle]) return;
    const double sign = a.forward == b.forward ? -1.0 : 1.0;
    const double length = (surface_.points.row(a.low) - surface_.points.row(a.high)).norm();
    neighbours_[static_cast<std::size_t>(a.triangle)].push_back(
        {b.triangle, b.opposite, sign, length});
    neighbours_[static_cast<std::size_t>(b.triangle)].push_back(
        {a.triangle, a.opposite, sign, length});
  }

  std::vector<int> grown_from(int seed, int number) {
    const Eigen::Vector3d normal = area_vector(surface_, seed).normalized();
    const Eigen::Vector3d origin = surface_.points.row(surface_.triangles(seed, 0));
    std::vector<int> found{seed};
    plane_[static_cast<std::size_t>(seed)] = number;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const Neighbour& next : neighbours_[static_cast<std::size_t>(found[i])]) {
        int& plane = plane_[static_cast<std::size_t>(next.triangle)];
        if (plane != -1) continue;
        const Eigen::Vector3d apex = surface_.points.row(next.apex);
        if (std::abs((apex - origin).dot(normal)) > tolerance_) continue;
        const Eigen::Vector3d area = next.sign * area_vector(surface_, next.triangle);
        if (area.dot(normal) < -tolerance_ * longest_edge(next.triangle)) continue;  // folded back
        plane = number;
        found.push_back(next.triangle);
      }
    }
    return found;
  }

  [[nodiscard]] double longest_edge(int t) const {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (surface_.points.row(surface_.triangles(t, k)) -
                                   surface_.points.row(surface_.triangles(t, (k + 1) % 3)))
                                      .norm());
    }
    return longest;
  }

  // Whether the plane is wide. 4 area / perimeter is twice the width of a strip, or the edge length
  // of a square.
  [[nodiscard]] bool is_wide(const std::vector<int>& triangles, int number) const {
    double area = 0.0;
    double perimeter = 0.0;
    for (const int t : triangles) {
      area += 0.5 * area_vector(surface_, t).norm();
      for (int k = 0; k < 3; ++k) {
        perimeter += (surface_.points.row(surface_.triangles(t, k)) -
                      surface_.points.row(surface_.triangles(t, (k + 1) % 3)))
                         .norm();
      }
      for (const Neighbour& next : neighbours_[static_cast<std::size_t>(t)]) {
        if (plane_[static_cast<std::size_t>(next.triangle)] == number) perimeter -= next.length;
      }
    }
    return 4.0 * area > 1.5 * width_ * perimeter;
  }

  const Surface& surface_;
  double width_, tolerance_;
  std::vector<int> plane_;  // −1: not tried yet, −2: in no wide plane
  std::vector<std::vector<Neighbour>> neighbours_;
};

// Whether all points of some triangles lie in one plane.
bool is_flat(const Surface& surface, const std::vector<int>& triangles) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (const int t : triangles) {
    const Eigen::Vector3d n = area_vector(surface, t);
    for (int k = 0; k < 3; ++k) {
      middle += n.norm() * surface.points.row(surface.triangles(t, k)).transpose() / 3.0;
    }
    normal += n;
    area += n.norm();
  }
  if (normal.norm() < 0.5 * area) return false;
  const double tolerance = rounding(surface);
  normal.normalize();
  middle /= area;
  return std::all_of(triangles.begin(), triangles.end(), [&](int t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d p = surface.points.row(surface.triangles(t, k));
      if (std::abs((p - middle).dot(normal)) > tolerance) return false;
    }
    return true;
  });
}

// The radius of each part. The sum of edge length times angle, divided by the area, is the mean of
// k1 + k2 (Steiner's formula).
std::vector<double> radii(const Surface& surface, const SmoothParts& parts,
                          const std::vector<EdgeUse>& uses) {
  const auto count =
      static_cast<std::size_t>(*std::max_element(parts.part.begin(), parts.part.end()) + 1);
  std::vector<std::vector<int>> triangles(count);
  std::vector<double> area(count, 0.0);
  std::vector<double> bend(count, 0.0);
  for (std::size_t t = 0; t < parts.part.size(); ++t) {
    const auto p = static_cast<std::size_t>(parts.part[t]);
    triangles[p].push_back(static_cast<int>(t));
    area[p] += 0.5 * area_vector(surface, static_cast<int>(t)).norm();
  }
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    const auto p =
        static_cast<std::size_t>(parts.part[static_cast<std::size_t>(uses[first].triangle)]);
    if (end - first == 2 &&
        static_cast<std::size_t>(parts.part[static_cast<std::size_t>(uses[first + 1].triangle)]) ==
            p) {
      const double length =
          (surface.points.row(uses[first].low) - surface.points.row(uses[first].high)).norm();
      bend[p] += length * turn(surface, uses[first], uses[first + 1]);
    }
    first = end;
  }
  std::vector<double> radius(count, infinity);
  for (std::size_t p = 0; p < count; ++p) {
    if (!is_flat(surface, triangles[p]) && bend[p] > 0.0) radius[p] = area[p] / bend[p];
  }
  return radius;
}

}  // namespace

bool SmoothParts::flat(int p) const { return radius[static_cast<std::size_t>(p)] == infinity; }

SmoothParts smooth_parts(const Surface& surface, double edge_length, double sharp_degrees) {
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  const std::vector<int> plane = Planes(surface, uses, edge_length).of_triangles();
  const double sharp = sharp_degrees * std::numbers::pi / 180.0;
  const auto stays = [&](const EdgeUse& a, const EdgeUse& b) {
    const int p = plane[static_cast<std::size_t>(a.triangle)];
    if (surface.patch[a.triangle] != surface.patch[b.triangle]) return true;
    if (p != plane[static_cast<std::size_t>(b.triangle)]) return true;
    return p < 0 && turn(surface, a, b) > sharp;
  };
  SmoothParts parts;
  DisjointSets joined(plane.size());
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    if (end - first != 2 || stays(uses[first], uses[first + 1])) {
      parts.kept.push_back(uses[first]);
    } else {
      joined.join(static_cast<std::size_t>(uses[first].triangle),
                  static_cast<std::size_t>(uses[first + 1].triangle));
    }
    first = end;
  }
  parts.part = joined.numbers();
  parts.radius = radii(surface, parts, uses);
  return parts;
}

}  // namespace chladni::mesh
