// Prepares a surface for isotropic remeshing: which edges must stay, and short enough ones.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "mesh/check.h"
#include "mesh/clean.h"
#include "mesh/defects.h"
#include "mesh/disjoint_sets.h"
#include "mesh/shells.h"

namespace chladni::mesh {
namespace {

Eigen::Vector3d normal(const Surface& surface, int t) {
  const Eigen::Vector3d a = surface.points.row(surface.triangles(t, 0));
  const Eigen::Vector3d b = surface.points.row(surface.triangles(t, 1));
  const Eigen::Vector3d c = surface.points.row(surface.triangles(t, 2));
  return (b - a).cross(c - a).normalized();
}

bool must_stay(const Surface& surface, const EdgeUse& a, const EdgeUse& b, double cos_sharp) {
  if (surface.patch[a.triangle] != surface.patch[b.triangle]) return true;
  const double turned = a.forward == b.forward ? -1.0 : 1.0;
  return turned * normal(surface, a.triangle).dot(normal(surface, b.triangle)) < cos_sharp;
}

// The first use of every edge that must stay.
std::vector<EdgeUse> kept_edges(const Surface& surface, const std::vector<EdgeUse>& uses,
                                double sharp_degrees) {
  const double cos_sharp = std::cos(sharp_degrees * std::numbers::pi / 180.0);
  std::vector<EdgeUse> kept;
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    if (end - first != 2 || must_stay(surface, uses[first], uses[first + 1], cos_sharp)) {
      kept.push_back(uses[first]);
    }
    first = end;
  }
  return kept;
}

// Per kept edge (low, high) its points from low to high, both ends included.
using Chains = std::map<std::pair<int, int>, std::vector<int>>;

// Cuts kept edges into equal parts of about `edge_length`, at most 4/3 of it, as isotropic
// remeshing wants them; the new points are appended.
Chains chains_of(Surface& surface, const std::vector<EdgeUse>& kept, double edge_length) {
  Chains chains;
  std::vector<Eigen::RowVector3d> added;
  for (const EdgeUse& edge : kept) {
    const Eigen::RowVector3d a = surface.points.row(edge.low);
    const Eigen::RowVector3d b = surface.points.row(edge.high);
    const double ratio = (b - a).norm() / edge_length;
    const int parts = ratio < 1.3 ? 1 : std::max(2, static_cast<int>(std::lround(ratio)));
    std::vector<int>& chain = chains[{edge.low, edge.high}];
    chain = {edge.low};
    for (int i = 1; i < parts; ++i) {
      chain.push_back(static_cast<int>(surface.points.rows()) + static_cast<int>(added.size()));
      added.emplace_back(a + (b - a) * (static_cast<double>(i) / parts));
    }
    chain.push_back(edge.high);
  }
  Eigen::Index i = surface.points.rows();
  surface.points.conservativeResize(i + static_cast<Eigen::Index>(added.size()), 3);
  for (const Eigen::RowVector3d& point : added) surface.points.row(i++) = point;
  return chains;
}

// A point of a triangle's rim and the sides (bit k: from corner k to the next) it lies on.
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

// Whether cutting off point i leaves no flat piece on either side of the cut.
bool is_ear(const std::vector<RimPoint>& rim, std::size_t i) {
  const std::size_t size = rim.size();
  if ((rim[(i + size - 1) % size].sides & rim[i].sides & rim[(i + 1) % size].sides) != 0) {
    return false;
  }
  unsigned sides = 7U;
  for (std::size_t j = 0; j < size; ++j) {
    if (j != i) sides &= rim[j].sides;
  }
  return sides == 0;
}

// Cuts off the ear with the shortest cut until a triangle is left.
void add_rim_triangles(const Points& points, std::vector<RimPoint> rim,
                       std::vector<Eigen::Vector3i>& triangles) {
  while (rim.size() > 3) {
    std::size_t best = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const int before = rim[(i + rim.size() - 1) % rim.size()].point;
      const int after = rim[(i + 1) % rim.size()].point;
      const double length = (points.row(before) - points.row(after)).norm();
      if (length < shortest && is_ear(rim, i)) {
        shortest = length;
        best = i;
      }
    }
    const RimPoint before = rim[(best + rim.size() - 1) % rim.size()];
    const RimPoint after = rim[(best + 1) % rim.size()];
    triangles.emplace_back(before.point, rim[best].point, after.point);
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

// Triangles joined across edges that need not stay.
std::vector<int> smooth_parts(const Surface& surface, const std::vector<EdgeUse>& kept) {
  const auto before = [](const EdgeUse& a, const EdgeUse& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  };
  DisjointSets parts(static_cast<std::size_t>(surface.triangles.rows()));
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  for (std::size_t i = 1; i < uses.size(); ++i) {
    const bool same_edge = uses[i].low == uses[i - 1].low && uses[i].high == uses[i - 1].high;
    if (!same_edge || std::binary_search(kept.begin(), kept.end(), uses[i], before)) continue;
    parts.join(static_cast<std::size_t>(uses[i - 1].triangle),
               static_cast<std::size_t>(uses[i].triangle));
  }
  return parts.numbers();
}

std::optional<Surface> remeshed(const Surface& surface, double edge_length, double sharp_degrees) {
  const std::vector<EdgeUse> kept =
      kept_edges(surface, edge_uses(surface.triangles), sharp_degrees);
  Surface parts = surface;
  const std::vector<int> part = smooth_parts(surface, kept);
  parts.patch = Eigen::Map<const Eigen::VectorXi>(part.data(), surface.patch.size());
  Eigen::VectorXi patch_of_part(surface.patch.size());
  for (Eigen::Index t = 0; t < surface.patch.size(); ++t) {
    patch_of_part[parts.patch[t]] = surface.patch[t];
  }
  const Chains chains = chains_of(parts, kept, edge_length);
  split_triangles(parts, chains);
  std::vector<Eigen::Vector2i> edges;
  for (const auto& [ends, chain] : chains) {
    for (std::size_t i = 1; i < chain.size(); ++i) edges.emplace_back(chain[i - 1], chain[i]);
  }
  std::optional<Surface> after = isotropic(parts, edges, edge_length);
  if (!after) return after;
  for (int& patch : after->patch) patch = patch_of_part[patch];
  return after;
}

// Closed where it was, free of crossings, and the same body to a thousandth of its volume.
bool stands_for(const Surface& after, const Surface& before) {
  if (holes(after).size() != holes(before).size()) return false;
  const double volume_before = material(before, shells(before)).volume;
  const double volume_after = material(after, shells(after)).volume;
  if (std::abs(volume_after - volume_before) > 1e-3 * volume_before) return false;
  Surface flat = after;
  return remove_degenerate_triangles(flat, smallest_length(after)) == 0 && crossings(after).empty();
}

}  // namespace

Surface remesh(const Surface& surface, double edge_length, double sharp_degrees) {
  require(std::isfinite(edge_length) && edge_length > 0.0,
          "remesh: edge_length is " + std::to_string(edge_length) + " m, expected more than 0");
  for (const double degrees : {sharp_degrees, sharp_degrees / 3.0, 1.0}) {
    const std::optional<Surface> after = remeshed(surface, edge_length, degrees);
    if (after && stands_for(*after, surface)) return *after;
  }
  return surface;
}

}  // namespace chladni::mesh
