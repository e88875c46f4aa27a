#include "mesh/remesh/split_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh/soundness/clean.h"

namespace chladni::mesh {
namespace {

// Cuts lines into equal parts; the new points are appended.
Chains chains_of(Surface& surface, const std::vector<LineToCut>& lines) {
  Chains chains;
  std::vector<Eigen::RowVector3d> added;
  for (const LineToCut& line : lines) {
    const Eigen::RowVector3d a = surface.points.row(line.low);
    const Eigen::RowVector3d b = surface.points.row(line.high);
    const double ratio = (b - a).norm() / line.edge_length;
    const int parts = ratio < 1.3 ? 1 : std::max(2, static_cast<int>(std::lround(ratio)));
    std::vector<int>& chain = chains[{line.low, line.high}];
    chain = {line.low};
    for (int i = 1; i < parts; ++i) {
      chain.push_back(static_cast<int>(surface.points.rows()) + static_cast<int>(added.size()));
      added.emplace_back(a + (b - a) * (static_cast<double>(i) / parts));
    }
    chain.push_back(line.high);
  }
  Eigen::Index i = surface.points.rows();
  surface.points.conservativeResize(i + static_cast<Eigen::Index>(added.size()), 3);
  for (const Eigen::RowVector3d& point : added) surface.points.row(i++) = point;
  return chains;
}

// A point of a triangle's rim, and the sides that it lies on (bit k: from corner k to the next).
struct RimPoint {
  int point = 0;
  unsigned sides = 0;
};

std::vector<RimPoint> rim_of(const Surface& surface, Eigen::Index t, const Chains& chains) {
  std::vector<RimPoint> rim;
  for (int k = 0; k < 3; ++k) {
    const int from = surface.triangles(t, k);
    const int to = surface.triangles(t, (k + 1) % 3);
    rim.push_back(
        {from, 1U << static_cast<unsigned>(k) | 1U << static_cast<unsigned>((k + 2) % 3)});
    const auto chain = chains.find({std::min(from, to), std::max(from, to)});
    if (chain == chains.end()) continue;
    std::vector<int> inner(chain->second.begin() + 1, chain->second.end() - 1);
    if (from > to) std::reverse(inner.begin(), inner.end());
    for (const int i : inner) rim.push_back({i, 1U << static_cast<unsigned>(k)});
  }
  return rim;
}

// The number of a rim's points on each side of its triangle.
class OnSides {
 public:
  explicit OnSides(const std::vector<RimPoint>& rim) {
    for (const RimPoint& point : rim) add(point, 1);
  }
  void remove(const RimPoint& point) { add(point, -1); }
  /// Whether `all` points but this one lie on one side.
  [[nodiscard]] bool others_in_line(const RimPoint& point, std::size_t all) const {
    for (unsigned k = 0; k < 3; ++k) {
      const auto others = count_[k] - static_cast<std::ptrdiff_t>(point.sides >> k & 1U);
      if (others == static_cast<std::ptrdiff_t>(all) - 1) return true;
    }
    return false;
  }

 private:
  void add(const RimPoint& point, std::ptrdiff_t change) {
    for (unsigned k = 0; k < 3; ++k) {
      if ((point.sides >> k & 1U) != 0) count_[k] += change;
    }
  }
  std::array<std::ptrdiff_t, 3> count_{};
};

// Whether cutting off point i leaves no flat piece on either side of the cut.
bool is_ear(const std::vector<RimPoint>& rim, const OnSides& on_sides, std::size_t i) {
  const std::size_t size = rim.size();
  const unsigned of_cut_off =
      rim[(i + size - 1) % size].sides & rim[i].sides & rim[(i + 1) % size].sides;
  return of_cut_off == 0 && !on_sides.others_in_line(rim[i], size);
}

// Cuts off the ear with the shortest cut, again and again, until one triangle is left. Cost:
// quadratic in the points.
void add_rim_triangles(const Points& points, std::vector<RimPoint> rim,
                       std::vector<Eigen::Vector3i>& triangles) {
  OnSides on_sides(rim);
  while (rim.size() > 3) {
    std::size_t best = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const int before = rim[i > 0 ? i - 1 : rim.size() - 1].point;
      const int after = rim[i + 1 < rim.size() ? i + 1 : 0].point;
      const double length = (points.row(before) - points.row(after)).norm();
      if (length < shortest && is_ear(rim, on_sides, i)) {
        shortest = length;
        best = i;
      }
    }
    const RimPoint before = rim[(best + rim.size() - 1) % rim.size()];
    const RimPoint after = rim[(best + 1) % rim.size()];
    triangles.emplace_back(before.point, rim[best].point, after.point);
    on_sides.remove(rim[best]);
    rim.erase(rim.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.emplace_back(rim[0].point, rim[1].point, rim[2].point);
}

void split_triangles(Surface& surface, const Chains& chains) {
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> patches;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    add_rim_triangles(surface.points, rim_of(surface, t, chains), triangles);
    patches.resize(triangles.size(), surface.patch[t]);
  }
  surface.triangles.resize(0, 3);
  surface.patch.resize(0);
  append_triangles(surface, triangles, patches);
}

}  // namespace

Chains split_edges(Surface& surface, const std::vector<LineToCut>& lines) {
  Chains chains = chains_of(surface, lines);
  split_triangles(surface, chains);
  return chains;
}

}  // namespace chladni::mesh
