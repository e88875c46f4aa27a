#include "mesh/soundness/shells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "mesh/disjoint_sets.h"

namespace chladni::mesh {
namespace {

double six_volumes(const Surface& surface, Eigen::Index t, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0)).transpose() - origin;
  const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1)).transpose() - origin;
  const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2)).transpose() - origin;
  return a.dot(b.cross(c));
}

int one_more_than_largest(const std::vector<int>& numbers) {
  return numbers.empty() ? 0 : 1 + *std::max_element(numbers.begin(), numbers.end());
}

// Sides are numbered 2 t (front) and 2 t + 1 (back). A triangle that runs from low to high has its
// front where the angle about low -> high grows.
std::size_t side_towards_growing_angle(const EdgeUse& use) {
  return static_cast<std::size_t>(2 * use.triangle + (use.forward ? 0 : 1));
}
std::size_t side_towards_falling_angle(const EdgeUse& use) {
  return static_cast<std::size_t>(2 * use.triangle + (use.forward ? 1 : 0));
}

// Sorts the uses of one edge by their angle about the edge.
void sort_about_edge(const Surface& surface, std::vector<EdgeUse>& uses) {
  if (uses.size() < 3) return;  // any order is a cyclic order
  const Eigen::Vector3d a = surface.points.row(uses[0].low);
  const Eigen::Vector3d axis = (surface.points.row(uses[0].high).transpose() - a).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal();
  const Eigen::Vector3d v = axis.cross(u);
  std::vector<std::pair<double, std::size_t>> angles;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const Eigen::Vector3d c = surface.points.row(uses[i].opposite).transpose() - a;
    angles.emplace_back(std::atan2(c.dot(v), c.dot(u)), i);
  }
  std::sort(angles.begin(), angles.end());
  std::vector<EdgeUse> sorted;
  for (const auto& [angle, i] : angles) sorted.push_back(uses[i]);
  uses = std::move(sorted);
}

}  // namespace

std::vector<EdgeUse> edge_uses(const Cells& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(static_cast<std::size_t>(3 * triangles.rows()));
  for (int t = 0; t < static_cast<int>(triangles.rows()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(t, k);
      const int to = triangles(t, (k + 1) % 3);
      uses.push_back(
          {std::min(from, to), std::max(from, to), t, triangles(t, (k + 2) % 3), from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return uses;
}

std::size_t end_of_edge(const std::vector<EdgeUse>& uses, std::size_t first) {
  std::size_t end = first + 1;
  while (end < uses.size() && uses[end].low == uses[first].low &&
         uses[end].high == uses[first].high) {
    ++end;
  }
  return end;
}

Shells shells(const Surface& surface) {
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  const auto count = static_cast<std::size_t>(surface.triangles.rows());
  DisjointSets sides(2 * count);
  DisjointSets components(count);
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    std::vector<EdgeUse> ring(uses.begin() + static_cast<std::ptrdiff_t>(first),
                              uses.begin() + static_cast<std::ptrdiff_t>(end));
    sort_about_edge(surface, ring);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const EdgeUse& next = ring[(i + 1) % ring.size()];
      sides.join(side_towards_growing_angle(ring[i]), side_towards_falling_angle(next));
      components.join(static_cast<std::size_t>(ring[i].triangle),
                      static_cast<std::size_t>(next.triangle));
    }
    first = end;
  }
  Shells found;
  const std::vector<int> shell = sides.numbers();
  found.component = components.numbers();
  found.component_count = one_more_than_largest(found.component);
  found.volume.assign(static_cast<std::size_t>(one_more_than_largest(shell)), 0.0);
  const Eigen::Vector3d origin = bounding_box(surface.points).colwise().mean();
  for (std::size_t t = 0; t < count; ++t) {
    found.front.push_back(shell[2 * t]);
    found.back.push_back(shell[2 * t + 1]);
    const double part = six_volumes(surface, static_cast<Eigen::Index>(t), origin) / 6.0;
    found.volume[static_cast<std::size_t>(shell[2 * t])] -= part;
    found.volume[static_cast<std::size_t>(shell[2 * t + 1])] += part;
  }
  return found;
}

double winding_number(const Surface& surface, const std::vector<int>& sign,
                      const Eigen::Vector3d& point) {
  double solid_angle = 0.0;  // Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (sign[static_cast<std::size_t>(t)] == 0) continue;
    const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0)).transpose() - point;
    const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1)).transpose() - point;
    const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2)).transpose() - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    solid_angle += sign[static_cast<std::size_t>(t)] * 2.0 * std::atan2(a.dot(b.cross(c)), below);
  }
  return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace chladni::mesh
