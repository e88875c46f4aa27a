#include "mesh/soundness/clean.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

using Key = std::array<std::int64_t, 3>;
struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::size_t hash = 0;
    for (const std::int64_t i : key)
      hash = (hash ^ static_cast<std::size_t>(i)) * 0x9E3779B97F4A7C15U;
    return hash ^ (hash >> 31U);
  }
};

// A grid of cells larger than the tolerance, to find near points. The first point replaces all
// points near it.
class PointGrid {
 public:
  PointGrid(const Points& points, double tolerance)
      : points_(points),
        tolerance_(tolerance),
        cell_(std::max({8.0 * tolerance,
                        1e-9 * (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm(),
                        std::numeric_limits<double>::min()})),
        origin_(points.colwise().minCoeff()) {}

  /// An earlier point within the tolerance of point i. Where there is none, adds i and returns i.
  int first_near(int i) {
    const Eigen::RowVector3d p = (points_.row(i) - origin_) / cell_;
    const Eigen::RowVector3d reach = Eigen::RowVector3d::Constant(tolerance_ / cell_);
    const Eigen::RowVector3d low = (p - reach).array().floor();
    const Eigen::RowVector3d high = (p + reach).array().floor();
    for (double x = low[0]; x <= high[0]; ++x) {
      for (double y = low[1]; y <= high[1]; ++y) {
        for (double z = low[2]; z <= high[2]; ++z) {
          const int near = near_in_cell(key({x, y, z}), i);
          if (near >= 0) return near;
        }
      }
    }
    cells_[key(p.array().floor())].push_back(i);
    return i;
  }

 private:
  static Key key(const Eigen::RowVector3d& p) {
    return {static_cast<std::int64_t>(p[0]), static_cast<std::int64_t>(p[1]),
            static_cast<std::int64_t>(p[2])};
  }

  [[nodiscard]] int near_in_cell(const Key& cell, int i) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return -1;
    for (const int j : found->second) {
      if ((points_.row(i) - points_.row(j)).norm() <= tolerance_) return j;
    }
    return -1;
  }

  const Points& points_;
  double tolerance_, cell_;
  Eigen::RowVector3d origin_;
  std::unordered_map<Key, std::vector<int>, KeyHash> cells_;
};

// Keeps the triangles marked 1.
int keep(Surface& surface, const std::vector<char>& kept) {
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (kept[static_cast<std::size_t>(t)] == 0) continue;
    surface.triangles.row(count) = surface.triangles.row(t);
    surface.patch[count++] = surface.patch[t];
  }
  const auto removed = static_cast<int>(surface.triangles.rows() - count);
  surface.triangles.conservativeResize(count, 3);
  surface.patch.conservativeResize(count);
  return removed;
}

bool uses_a_point_twice(const Surface& surface, Eigen::Index t) {
  const auto row = surface.triangles.row(t);
  return row[0] == row[1] || row[1] == row[2] || row[2] == row[0];
}

// The corner opposite the longest edge of triangle t if it lies within `tolerance` of this edge,
// else -1.
int corner_on_longest_edge(const Surface& surface, Eigen::Index t, double tolerance) {
  int corner = 0;
  double longest = -1.0;
  for (int k = 0; k < 3; ++k) {
    const double length = (surface.points.row(surface.triangles(t, (k + 1) % 3)) -
                           surface.points.row(surface.triangles(t, (k + 2) % 3)))
                              .norm();
    if (length > longest) {
      longest = length;
      corner = k;
    }
  }
  const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
  const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1));
  const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2));
  return (b - a).cross(c - a).norm() <= tolerance * longest ? corner : -1;
}

// Cuts triangle t at point `middle` of its edge between `a` and `b`. t keeps the half with a; the
// half with b is returned.
Eigen::Vector3i split(Surface& surface, Eigen::Index t, int a, int b, int middle) {
  Eigen::Vector3i half = surface.triangles.row(t).transpose();
  for (int k = 0; k < 3; ++k) {
    if (half[k] == a) half[k] = middle;
    if (surface.triangles(t, k) == b) surface.triangles(t, k) = middle;
  }
  return half;
}

std::vector<int> triangles_of_edge(const std::vector<EdgeUse>& uses, int a, int b) {
  const std::pair<int, int> ends = std::minmax(a, b);
  auto use = std::lower_bound(uses.begin(), uses.end(), ends,
                              [](const EdgeUse& u, const std::pair<int, int>& edge) {
                                return std::pair(u.low, u.high) < edge;
                              });
  std::vector<int> triangles;
  for (; use != uses.end() && std::pair(use->low, use->high) == ends; ++use) {
    triangles.push_back(use->triangle);
  }
  return triangles;
}

// Removes triangles with a height below `tolerance`, except where this pass has already changed one
// of the triangles at their longest edge.
int cut_out_flat_triangles(Surface& surface, double tolerance) {
  const Eigen::Index count = surface.triangles.rows();
  std::vector<int> flat_corner(static_cast<std::size_t>(count), -1);
  bool any = false;
  for (Eigen::Index t = 0; t < count; ++t) {
    const int corner = corner_on_longest_edge(surface, t, tolerance);
    flat_corner[static_cast<std::size_t>(t)] = corner;
    any = any || corner >= 0;
  }
  if (!any) return 0;
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  std::vector<char> kept(static_cast<std::size_t>(count), 1);
  std::vector<char> touched(static_cast<std::size_t>(count), 0);
  std::vector<Eigen::Vector3i> halves;
  std::vector<int> half_patches;
  for (Eigen::Index t = 0; t < count; ++t) {
    const int corner = flat_corner[static_cast<std::size_t>(t)];
    if (corner < 0) continue;
    const int middle = surface.triangles(t, corner);
    const int a = surface.triangles(t, (corner + 1) % 3);
    const int b = surface.triangles(t, (corner + 2) % 3);
    const std::vector<int> around = triangles_of_edge(uses, a, b);
    const bool free = std::none_of(around.begin(), around.end(), [&](int n) {
      return touched[static_cast<std::size_t>(n)] == 1;
    });
    if (!free) continue;
    for (const int n : around) {
      touched[static_cast<std::size_t>(n)] = 1;
      if (n == t) continue;
      halves.push_back(split(surface, n, a, b, middle));
      half_patches.push_back(surface.patch[n]);
    }
    kept[static_cast<std::size_t>(t)] = 0;
  }
  const int removed = keep(surface, kept);
  append_triangles(surface, halves, half_patches);
  return removed;
}

}  // namespace

double smallest_length(const Surface& surface) {
  const auto box = bounding_box(surface.points);
  return 1e-9 * (box.row(1) - box.row(0)).norm();
}

int merge_points(Surface& surface, double tolerance) {
  if (surface.points.rows() == 0) return 0;
  PointGrid grid(surface.points, tolerance);
  Eigen::VectorXi number(surface.points.rows());
  int merged = 0;
  for (int i = 0; i < static_cast<int>(number.size()); ++i) {
    number[i] = grid.first_near(i);
    if (number[i] != i) ++merged;
  }
  for (std::int32_t& i : surface.triangles.reshaped()) i = number[i];
  return merged;
}

int remove_duplicate_triangles(Surface& surface) {
  std::unordered_map<Key, int, KeyHash> seen;
  std::vector<char> kept(static_cast<std::size_t>(surface.triangles.rows()), 1);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    Key key{surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)};
    std::sort(key.begin(), key.end());
    if (!seen.emplace(key, 1).second) kept[static_cast<std::size_t>(t)] = 0;
  }
  return keep(surface, kept);
}

int remove_unused_points(Surface& surface) {
  Eigen::VectorXi number = Eigen::VectorXi::Constant(surface.points.rows(), -1);
  for (const std::int32_t i : surface.triangles.reshaped()) number[i] = 0;
  int used = 0;
  for (Eigen::Index i = 0; i < surface.points.rows(); ++i) {
    if (number[i] < 0) continue;
    surface.points.row(used) = surface.points.row(i);
    number[i] = used++;
  }
  const auto removed = static_cast<int>(surface.points.rows() - used);
  surface.points.conservativeResize(used, 3);
  for (std::int32_t& i : surface.triangles.reshaped()) i = number[i];
  return removed;
}

int remove_degenerate_triangles(Surface& surface, double tolerance) {
  constexpr int largest_pass_count = 100;  // each pass shortens the remaining longest edges
  int removed = 0;
  for (int pass = 0; pass < largest_pass_count; ++pass) {
    std::vector<char> kept(static_cast<std::size_t>(surface.triangles.rows()), 1);
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      if (uses_a_point_twice(surface, t)) kept[static_cast<std::size_t>(t)] = 0;
    }
    removed += keep(surface, kept);
    const int cut = cut_out_flat_triangles(surface, tolerance);
    if (cut == 0) break;
    removed += cut;
  }
  return removed;
}

void append_triangles(Surface& surface, const std::vector<Eigen::Vector3i>& triangles,
                      const std::vector<int>& patches) {
  Eigen::Index t = surface.triangles.rows();
  const Eigen::Index count = t + static_cast<Eigen::Index>(triangles.size());
  surface.triangles.conservativeResize(count, 3);
  surface.patch.conservativeResize(count);
  for (std::size_t i = 0; i < triangles.size(); ++i, ++t) {
    surface.triangles.row(t) = triangles[i].transpose();
    surface.patch[t] = patches[i];
  }
}

}  // namespace chladni::mesh
