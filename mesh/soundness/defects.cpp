#include "mesh/soundness/defects.h"

#include <algorithm>
#include <map>
#include <set>

#include "mesh/disjoint_sets.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

// For each point, its neighbours along edges with only one triangle. The orientation of the
// triangles does not matter.
std::map<int, std::vector<int>> boundary_neighbours(const std::vector<EdgeUse>& uses) {
  std::map<int, std::vector<int>> neighbours;
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    if (end - first == 1) {
      neighbours[uses[first].low].push_back(uses[first].high);
      neighbours[uses[first].high].push_back(uses[first].low);
    }
    first = end;
  }
  return neighbours;
}

// The hole connected with `start`, with points in order along the loop where the hole is simple.
Hole hole_from(int start, const std::map<int, std::vector<int>>& neighbours, std::set<int>& seen,
               const Surface& surface) {
  Hole hole;
  hole.simple = true;
  hole.centre.setZero();
  std::vector<int> ahead{start};
  int ends = 0;
  while (!ahead.empty()) {
    const int point = ahead.back();
    ahead.pop_back();
    if (!seen.insert(point).second) continue;
    const std::vector<int>& next = neighbours.at(point);
    hole.simple = hole.simple && next.size() == 2;
    hole.points.push_back(point);
    hole.centre += surface.points.row(point).transpose();
    ends += static_cast<int>(next.size());
    ahead.insert(ahead.end(), next.begin(), next.end());
  }
  hole.edges = ends / 2;
  hole.centre /= static_cast<double>(hole.points.size());
  return hole;
}

}  // namespace

std::vector<Hole> holes(const Surface& surface) {
  const std::map<int, std::vector<int>> neighbours =
      boundary_neighbours(edge_uses(surface.triangles));
  std::set<int> seen;
  std::vector<Hole> found;
  for (const auto& [point, next] : neighbours) {
    if (!seen.contains(point)) found.push_back(hole_from(point, neighbours, seen, surface));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Hole& a, const Hole& b) { return a.edges > b.edges; });
  return found;
}

std::vector<Eigen::Vector2i> crowded_edges(const Surface& surface) {
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  std::vector<Eigen::Vector2i> found;
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    if (end - first > 2) found.emplace_back(uses[first].low, uses[first].high);
    first = end;
  }
  return found;
}

std::vector<int> pinched_points(const Surface& surface) {
  // Corner k of triangle t has the number 3 t + k. Corners at one point join across shared edges.
  DisjointSets corners(static_cast<std::size_t>(surface.triangles.size()));
  const auto corner = [&](int t, int point) {
    int k = 0;
    while (surface.triangles(t, k) != point) ++k;
    return static_cast<std::size_t>(3 * t + k);
  };
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  for (std::size_t i = 1; i < uses.size(); ++i) {
    const EdgeUse& a = uses[i - 1];
    const EdgeUse& b = uses[i];
    if (a.low != b.low || a.high != b.high) continue;
    corners.join(corner(a.triangle, a.low), corner(b.triangle, b.low));
    corners.join(corner(a.triangle, a.high), corner(b.triangle, b.high));
  }
  std::vector<int> fan(static_cast<std::size_t>(surface.points.rows()), -1);
  std::set<int> pinched;
  for (int t = 0; t < static_cast<int>(surface.triangles.rows()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int point = surface.triangles(t, k);
      const auto root = static_cast<int>(corners.root(static_cast<std::size_t>(3 * t + k)));
      int& known = fan[static_cast<std::size_t>(point)];
      if (known >= 0 && known != root) pinched.insert(point);
      known = root;
    }
  }
  return {pinched.begin(), pinched.end()};
}

}  // namespace chladni::mesh
