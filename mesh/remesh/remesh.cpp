#include "mesh/remesh/remesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "base/error.h"
#include "mesh/check.h"
#include "mesh/remesh/feature_lines.h"
#include "mesh/remesh/plane_triangles.h"
#include "mesh/remesh/restore_volumes.h"
#include "mesh/remesh/smooth_parts.h"
#include "mesh/remesh/split_edges.h"
#include "mesh/soundness/clean.h"
#include "mesh/soundness/defects.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

constexpr double kMostTriangles = 2e6;  // some minutes

enum class Flat { fewest, renewed };

struct Wanted {
  double edge_length = 0.0;  // [m]
  double sharp_degrees = 0.0;
  double deviation = 0.0;  // of chords from the lines they replace, in edge lengths
  Flat flat = Flat::fewest;

  [[nodiscard]] Sampling sampling() const {
    return {edge_length, deviation * edge_length, std::numbers::pi / 4.0};
  }
};

using Edge = std::pair<int, int>;  // ends, low first

// A surface during remeshing. Its patches are the smooth parts of the original surface.
struct Rebuilt {
  Surface surface;
  SmoothParts of;                           // the parts of the original surface
  std::vector<double> edge_length;          // per part; 0 where its triangles are not renewed
  std::vector<std::map<Edge, int>> border;  // per part: its kept edges and their number of uses
  Chains chains;                            // the kept edges
};

// Takes the shortest of lengths that are nearly the same. Each length costs a walk through the
// whole surface, and rounds of one radius differ in their last digits.
void join_near(std::vector<double>& lengths) {
  constexpr double kNear = 1.02;
  std::vector<double> sorted = lengths;
  std::sort(sorted.begin(), sorted.end());
  std::map<double, double> joined;
  double shortest = 0.0;
  for (const double length : sorted) {
    if (length > kNear * shortest) shortest = length;
    joined[length] = shortest;
  }
  for (double& length : lengths) length = joined[length];
}

std::vector<double> edge_lengths(const SmoothParts& parts, const Wanted& wanted) {
  std::vector<double> lengths;
  for (std::size_t p = 0; p < parts.radius.size(); ++p) {
    if (parts.flat(static_cast<int>(p))) {
      lengths.push_back(wanted.flat == Flat::renewed ? wanted.edge_length : 0.0);
    } else {
      // A tighter deviation of the lines does not make the triangles between them ever finer.
      Sampling sampling = wanted.sampling();
      sampling.deviation = std::max(sampling.deviation, wanted.edge_length / 400.0);
      lengths.push_back(chord_length(parts.radius[p], sampling));
    }
  }
  join_near(lengths);
  return lengths;
}

// Finds for each part its kept edges between the remaining points.
void find_borders(Rebuilt& rebuilt, const Surface& before, const std::vector<int>& stand_in) {
  const auto less = [](const EdgeUse& a, const EdgeUse& b) {
    return Edge(a.low, a.high) < Edge(b.low, b.high);
  };
  rebuilt.border.resize(rebuilt.edge_length.size());
  for (const EdgeUse& use : edge_uses(before.triangles)) {
    if (!std::binary_search(rebuilt.of.kept.begin(), rebuilt.of.kept.end(), use, less)) continue;
    const Edge edge = std::minmax(stand_in[static_cast<std::size_t>(use.low)],
                                  stand_in[static_cast<std::size_t>(use.high)]);
    if (edge.first == edge.second) continue;
    const int part = rebuilt.of.part[static_cast<std::size_t>(use.triangle)];
    ++rebuilt.border[static_cast<std::size_t>(part)][edge];
  }
}

// Adds the curved parts with straightened lines. Flat parts come later.
void add_curved_parts(Rebuilt& rebuilt, const Surface& before, const std::vector<int>& stand_in) {
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> parts;
  for (std::size_t t = 0; t < rebuilt.of.part.size(); ++t) {
    if (rebuilt.of.flat(rebuilt.of.part[t])) continue;
    Eigen::Vector3i corners = before.triangles.row(static_cast<Eigen::Index>(t)).transpose();
    for (int& i : corners) i = stand_in[static_cast<std::size_t>(i)];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    triangles.push_back(corners);
    parts.push_back(rebuilt.of.part[t]);
  }
  append_triangles(rebuilt.surface, triangles, parts);
}

// The lines to cut. The renewed part with the shortest edge length decides for each line.
std::vector<LineToCut> lines_to_cut(const Rebuilt& rebuilt) {
  std::map<Edge, double> length;
  for (std::size_t p = 0; p < rebuilt.border.size(); ++p) {
    if (rebuilt.edge_length[p] <= 0.0) continue;
    for (const auto& [edge, uses] : rebuilt.border[p]) {
      double& wanted = length.try_emplace(edge, rebuilt.edge_length[p]).first->second;
      wanted = std::min(wanted, rebuilt.edge_length[p]);
    }
  }
  std::vector<LineToCut> lines;
  for (const auto& [edge, wanted] : length) lines.push_back({edge.first, edge.second, wanted});
  return lines;
}

// The edges inside the curved parts that are much longer than the triangles wanted there: the long
// sides of the slivers along a round. Uncut, each of them would be halved again and again together
// with all its neighbours, at a cost that is quadratic in its length.
std::vector<LineToCut> long_inner_edges(const Rebuilt& rebuilt,
                                        const std::vector<LineToCut>& border) {
  constexpr double kLong = 30.0;
  std::set<Edge> known;
  for (const LineToCut& line : border) known.emplace(line.low, line.high);
  std::vector<LineToCut> lines;
  for (const EdgeUse& use : edge_uses(rebuilt.surface.triangles)) {
    const auto part = static_cast<std::size_t>(rebuilt.surface.patch[use.triangle]);
    const double wanted = rebuilt.edge_length[part];
    const auto& points = rebuilt.surface.points;
    const double length = (points.row(use.low) - points.row(use.high)).norm();
    if (wanted <= 0.0 || length < kLong * wanted) continue;
    if (known.emplace(use.low, use.high).second) lines.push_back({use.low, use.high, wanted});
  }
  return lines;
}

// Cuts the lines between the parts, which are kept, and long edges inside the curved parts.
void cut_lines(Rebuilt& rebuilt, const std::vector<LineToCut>& border) {
  const auto inner = long_inner_edges(rebuilt, border);
  auto lines = border;
  lines.insert(lines.end(), inner.begin(), inner.end());
  rebuilt.chains = split_edges(rebuilt.surface, lines);
  for (const LineToCut& line : inner) rebuilt.chains.erase({line.low, line.high});
}

// About as many triangles as isotropic remeshing makes: equilateral ones on the parts, and two at
// each piece of a line.
double expected_triangles(const Rebuilt& rebuilt, const Surface& before,
                          const std::vector<LineToCut>& lines) {
  const double equilateral = std::sqrt(3.0) / 4.0;
  double count = 0.0;
  for (Eigen::Index t = 0; t < before.triangles.rows(); ++t) {
    const auto part = static_cast<std::size_t>(rebuilt.of.part[static_cast<std::size_t>(t)]);
    const double length = rebuilt.edge_length[part];
    const Cells one = before.triangles.row(t);
    if (length > 0.0) count += area(before.points, one) / (equilateral * length * length);
  }
  for (const LineToCut& line : lines) {
    count += 2.0 * (before.points.row(line.low) - before.points.row(line.high)).norm() /
             line.edge_length;
  }
  return count;
}

// The border lines of a flat part, after the cuts.
std::vector<PlaneLine> border_of(const Rebuilt& rebuilt, std::size_t part) {
  std::vector<PlaneLine> lines;
  for (const auto& [edge, uses] : rebuilt.border[part]) {
    const auto chain = rebuilt.chains.find(edge);
    const std::vector<int> points =
        chain == rebuilt.chains.end() ? std::vector{edge.first, edge.second} : chain->second;
    for (std::size_t i = 1; i < points.size(); ++i) {
      lines.push_back({points[i - 1], points[i], uses});
    }
  }
  return lines;
}

bool add_flat_parts(Rebuilt& rebuilt, const Surface& before) {
  const Points normal = part_normals(before, rebuilt.of.part);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> parts;
  for (std::size_t p = 0; p < rebuilt.edge_length.size(); ++p) {
    if (!rebuilt.of.flat(static_cast<int>(p))) continue;
    const auto found = plane_triangles(rebuilt.surface.points, {}, border_of(rebuilt, p),
                                       normal.row(static_cast<Eigen::Index>(p)));
    if (!found) return false;
    triangles.insert(triangles.end(), found->begin(), found->end());
    parts.resize(triangles.size(), static_cast<int>(p));
  }
  append_triangles(rebuilt.surface, triangles, parts);
  return true;
}

// Replaces the triangles of planes after isotropic remeshing by Delaunay triangles between the same
// points.
void make_planes_delaunay(Surface& after, const Rebuilt& before) {
  const std::vector<int> part(after.patch.begin(), after.patch.end());
  const Points normal = part_normals(after, part);
  std::vector<std::vector<PlaneLine>> lines(before.edge_length.size());
  const std::vector<EdgeUse> uses = edge_uses(after.triangles);
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    for (std::size_t i = first; i < end; ++i) {
      const int p = after.patch[uses[i].triangle];
      const bool inner = end - first == 2 && p == after.patch[uses[first].triangle] &&
                         p == after.patch[uses[first + 1].triangle];
      if (!inner) lines[static_cast<std::size_t>(p)].push_back({uses[i].low, uses[i].high, 1});
    }
    first = end;
  }
  std::vector<std::vector<Eigen::Vector3i>> old(before.edge_length.size());
  for (Eigen::Index t = 0; t < after.triangles.rows(); ++t) {
    old[static_cast<std::size_t>(after.patch[t])].emplace_back(after.triangles.row(t).transpose());
  }
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> parts;
  for (std::size_t p = 0; p < old.size(); ++p) {
    const bool flat = before.of.flat(static_cast<int>(p));
    const auto found = flat ? plane_triangles(after.points, old[p], lines[p],
                                              normal.row(static_cast<Eigen::Index>(p)))
                            : std::nullopt;
    const auto& kept = found ? *found : old[p];
    triangles.insert(triangles.end(), kept.begin(), kept.end());
    parts.resize(triangles.size(), static_cast<int>(p));
  }
  after.triangles.resize(0, 3);
  after.patch.resize(0);
  append_triangles(after, triangles, parts);
}

// Rounds far smaller than the edge length must not take minutes and gigabytes.
void refuse_too_many_triangles(const Rebuilt& rebuilt, double triangles) {
  double shortest = HUGE_VAL;
  for (const double length : rebuilt.edge_length) {
    if (length > 0.0) shortest = std::min(shortest, length);
  }
  if (triangles <= kMostTriangles) return;
  throw InvalidInput(fmt::format(
      "remesh: the surface needs about {:.2g} million triangles, whose edges are {:.3g} mm long "
      "where it bends most; at most {:.0f} million are made. Leave small rounds out in CAD, take a "
      "longer mesh.edge_length, or set mesh.remesh = false",
      1e-6 * triangles, 1e3 * shortest, 1e-6 * kMostTriangles));
}

std::optional<Rebuilt> rebuilt(const Surface& before, const Wanted& wanted) {
  Rebuilt result;
  result.of = smooth_parts(before, wanted.edge_length, wanted.sharp_degrees);
  result.edge_length = edge_lengths(result.of, wanted);
  const std::vector<int> stand_in = stand_ins(before, result.of.kept, wanted.sampling());
  find_borders(result, before, stand_in);
  result.surface = before;
  result.surface.triangles.resize(0, 3);
  result.surface.patch.resize(0);
  add_curved_parts(result, before, stand_in);
  const auto lines = lines_to_cut(result);
  refuse_too_many_triangles(result, expected_triangles(result, before, lines));
  cut_lines(result, lines);
  if (!add_flat_parts(result, before)) return std::nullopt;
  remove_degenerate_triangles(result.surface, smallest_length(before));
  return result;
}

std::vector<Eigen::Vector2i> pieces(const Chains& chains) {
  std::vector<Eigen::Vector2i> ends;
  for (const auto& [edge, chain] : chains) {
    for (std::size_t i = 1; i < chain.size(); ++i) ends.emplace_back(chain[i - 1], chain[i]);
  }
  return ends;
}

std::optional<Surface> remeshed(const Surface& before, const Wanted& wanted) {
  std::optional<Rebuilt> ready = rebuilt(before, wanted);
  if (!ready) return std::nullopt;
  std::optional<Surface> after =
      isotropic(ready->surface, pieces(ready->chains), ready->edge_length);
  if (!after) return std::nullopt;
  std::vector<double> most;
  for (std::size_t p = 0; p < ready->edge_length.size(); ++p) {
    most.push_back(ready->of.flat(static_cast<int>(p)) ? 0.0 : 0.1 * ready->edge_length[p]);
  }
  restore_volumes(*after, ready->surface, most);
  if (wanted.flat == Flat::renewed) make_planes_delaunay(*after, *ready);
  remove_degenerate_triangles(*after, smallest_length(before));
  Eigen::VectorXi patch(ready->edge_length.size());
  for (Eigen::Index t = 0; t < before.patch.size(); ++t) {
    patch[ready->of.part[static_cast<std::size_t>(t)]] = before.patch[t];
  }
  for (int& p : after->patch) p = patch[p];
  remove_unused_points(*after);
  return after;
}

// Whether `after` may replace `before`: it has as many holes, no crossings, and the same volume to
// a thousandth.
bool stands_for(const Surface& after, const Surface& before) {
  if (holes(after).size() != holes(before).size()) return false;
  if (before.regions.size() < 2 && crowded_edges(after).size() > crowded_edges(before).size()) {
    return false;
  }
  const double volume_before = material(before, shells(before)).volume;
  const double volume_after = material(after, shells(after)).volume;
  if (std::abs(volume_after - volume_before) > 1e-3 * volume_before) return false;
  return crossings(after).empty();
}

// The first acceptable result of several ways. Each way follows the surface more closely than the
// way before.
Surface remeshed(const Surface& surface, double edge_length, double sharp_degrees, Flat flat) {
  const Wanted ways[] = {{edge_length, sharp_degrees, 1.0 / 50.0, flat},
                         {edge_length, sharp_degrees, 1.0 / 400.0, flat},
                         {edge_length, sharp_degrees / 3.0, 1.0 / 3000.0, flat},
                         {edge_length, 1.0, 0.0, flat}};
  for (const Wanted& wanted : ways) {
    const std::optional<Surface> after = remeshed(surface, wanted);
    if (after && stands_for(*after, surface)) return *after;
  }
  return surface;
}

}  // namespace

Surface remesh(const Surface& surface, double edge_length, double sharp_degrees) {
  require(std::isfinite(edge_length) && edge_length > 0.0,
          "remesh: edge_length is " + fmt::to_string(edge_length) + " m, expected more than 0");
  return remeshed(surface, edge_length, sharp_degrees, Flat::renewed);
}

Surface with_fewest_planes(const Surface& surface, double edge_length) {
  return remeshed(surface, edge_length, 30.0, Flat::fewest);
}

bool is_curved(const Surface& surface, double edge_length) {
  const SmoothParts parts = smooth_parts(surface, edge_length, 30.0);
  const auto& radius = parts.radius;
  return std::any_of(radius.begin(), radius.end(), [](double r) { return std::isfinite(r); });
}

}  // namespace chladni::mesh
