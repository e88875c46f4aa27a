// Crossing triangles, filled holes and isotropic triangles, by CGAL. Only files named cgal_*
// include CGAL.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "mesh/disjoint_sets.h"
#include "mesh/remesh/cgal_quiet.h"
#include "mesh/soundness/defects.h"
#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;
namespace pmp = CGAL::Polygon_mesh_processing;

Point point(const Surface& surface, int i) {
  return {surface.points(i, 0), surface.points(i, 1), surface.points(i, 2)};
}

std::vector<Box> boxes_of(const Surface& surface) {
  std::vector<Box> boxes;
  for (int t = 0; t < static_cast<int>(surface.triangles.rows()); ++t) {
    CGAL::Bbox_3 box;
    for (int k = 0; k < 3; ++k) box += point(surface, surface.triangles(t, k)).bbox();
    boxes.emplace_back(box, t);
  }
  return boxes;
}

// Corners of triangles a and b. Shared corners come first and in the same order.
struct Pair {
  std::array<int, 3> a, b;
  int shared = 0;
};
Pair pair_of(const Surface& surface, int first, int second) {
  Pair pair;
  for (std::size_t k = 0; k < 3; ++k) {
    pair.a[k] = surface.triangles(first, static_cast<Eigen::Index>(k));
    pair.b[k] = surface.triangles(second, static_cast<Eigen::Index>(k));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const auto free = static_cast<std::size_t>(pair.shared);
    const auto same = std::find(pair.b.begin() + pair.shared, pair.b.end(), pair.a[k]);
    if (same == pair.b.end()) continue;
    std::swap(pair.a[free], pair.a[k]);
    std::swap(pair.b[free], *same);
    ++pair.shared;
  }
  return pair;
}

bool cross(const Surface& surface, int first, int second) {
  const Pair pair = pair_of(surface, first, second);
  std::array<Point, 3> a;
  std::array<Point, 3> b;
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = point(surface, pair.a[k]);
    b[k] = point(surface, pair.b[k]);
  }
  const Kernel::Triangle_3 triangle_a(a[0], a[1], a[2]);
  const Kernel::Triangle_3 triangle_b(b[0], b[1], b[2]);
  if (triangle_a.is_degenerate() || triangle_b.is_degenerate()) return false;
  switch (pair.shared) {
    case 0:
      return CGAL::do_intersect(triangle_a, triangle_b);
    case 1:
      return CGAL::do_intersect(Kernel::Segment_3(a[1], a[2]), triangle_b) ||
             CGAL::do_intersect(Kernel::Segment_3(b[1], b[2]), triangle_a);
    case 2:  // folded flat onto each other
      return CGAL::coplanar(a[0], a[1], a[2], b[2]) &&
             CGAL::coplanar_orientation(a[0], a[1], a[2], b[2]) == CGAL::POSITIVE;
    default:
      return true;
  }
}

Eigen::Vector3d middle_of_overlap(const Box& a, const Box& b) {
  Eigen::Vector3d middle;
  for (int k = 0; k < 3; ++k) {
    middle[k] =
        0.5 * (std::max(a.min_coord(k), b.min_coord(k)) + std::min(a.max_coord(k), b.max_coord(k)));
  }
  return middle;
}

// A CGAL mesh of the triangles that are resampled. Its points are the fans of the surface. A fan is
// the set of triangle corners at one point that are connected across edges with exactly two
// triangles. All other triangles stay out: CGAL computes a normal at each point, at a cost that is
// cubic in the number of its triangles, and the fewest triangles of a plane meet by thousands.
struct FanMesh {
  Mesh mesh;
  Mesh::Property_map<Mesh::Face_index, int> patch;
  Mesh::Property_map<Mesh::Edge_index, bool> kept;
  Mesh::Property_map<Mesh::Vertex_index, int> origin;  // the surface's point, −1 for new ones
};

// Whether triangles of a surface are resampled.
std::vector<bool> resampled(const Surface& surface, const std::vector<double>& edge_length) {
  std::vector<bool> is;
  for (const int p : surface.patch) is.push_back(edge_length[static_cast<std::size_t>(p)] > 0.0);
  return is;
}

std::vector<std::int32_t> fans_of(const Surface& surface, const std::vector<bool>& is_resampled) {
  DisjointSets corners(static_cast<std::size_t>(surface.triangles.size()));
  const auto corner = [&](int t, int i) {
    int k = 0;
    while (surface.triangles(t, k) != i) ++k;
    return static_cast<std::size_t>(3 * t + k);
  };
  const std::vector<EdgeUse> uses = edge_uses(surface.triangles);
  for (std::size_t first = 0; first < uses.size();) {
    const std::size_t end = end_of_edge(uses, first);
    const EdgeUse& a = uses[first];
    const EdgeUse& b = uses[end - 1];
    if (end - first == 2 && is_resampled[static_cast<std::size_t>(a.triangle)] &&
        is_resampled[static_cast<std::size_t>(b.triangle)]) {
      corners.join(corner(a.triangle, a.low), corner(b.triangle, a.low));
      corners.join(corner(a.triangle, a.high), corner(b.triangle, a.high));
    }
    first = end;
  }
  return corners.numbers();
}

bool between_patches(const FanMesh& fans, Mesh::Edge_index edge) {
  const Mesh::Halfedge_index half = fans.mesh.halfedge(edge);
  return fans.patch[fans.mesh.face(half)] != fans.patch[fans.mesh.face(fans.mesh.opposite(half))];
}

// The different edge lengths. Patches with one edge length are resampled in one call, because each
// call works through the whole mesh.
std::set<double> lengths_of(const std::vector<double>& edge_length) {
  std::set<double> lengths(edge_length.begin(), edge_length.end());
  lengths.erase(0.0);
  return lengths;
}

void keep_edges(FanMesh& fans, const std::vector<Eigen::Vector2i>& kept) {
  std::vector<std::pair<int, int>> wanted;
  for (const Eigen::Vector2i& edge : kept) wanted.emplace_back(edge.minCoeff(), edge.maxCoeff());
  std::sort(wanted.begin(), wanted.end());
  for (const Mesh::Edge_index edge : fans.mesh.edges()) {
    const int a = fans.origin[fans.mesh.vertex(edge, 0)];
    const int b = fans.origin[fans.mesh.vertex(edge, 1)];
    fans.kept[edge] =
        fans.mesh.is_border(edge) || between_patches(fans, edge) ||
        std::binary_search(wanted.begin(), wanted.end(), std::pair(std::min(a, b), std::max(a, b)));
  }
}

std::optional<FanMesh> fan_mesh(const Surface& surface, const std::vector<Eigen::Vector2i>& kept,
                                const std::vector<bool>& is_resampled) {
  FanMesh fans;
  fans.patch = fans.mesh.add_property_map<Mesh::Face_index, int>("f:of", 0).first;
  fans.kept = fans.mesh.add_property_map<Mesh::Edge_index, bool>("e:kept", false).first;
  fans.origin = fans.mesh.add_property_map<Mesh::Vertex_index, int>("v:origin", -1).first;
  const std::vector<std::int32_t> fan = fans_of(surface, is_resampled);
  std::map<std::int32_t, Mesh::Vertex_index> vertex_of_fan;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (!is_resampled[static_cast<std::size_t>(t)]) continue;
    std::array<Mesh::Vertex_index, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] = vertex_of_fan.try_emplace(fan[static_cast<std::size_t>(3 * t + k)]);
      const int i = surface.triangles(t, k);
      if (is_new) {
        at->second = fans.mesh.add_vertex(point(surface, i));
        fans.origin[at->second] = i;
      }
      corners[static_cast<std::size_t>(k)] = at->second;
    }
    const Mesh::Face_index face = fans.mesh.add_face(corners[0], corners[1], corners[2]);
    if (face == Mesh::null_face()) return std::nullopt;
    fans.patch[face] = surface.patch[t];
  }
  keep_edges(fans, kept);
  return fans;
}

// The view of the mesh for CGAL while the patches of one edge length are resampled. All other faces
// form one patch, and only kept edges of the resampled faces count. Otherwise CGAL's check for too
// long kept edges (remesh.h, protect_constraints) would refuse because of edges elsewhere.
struct Turn {
  Mesh::Property_map<Mesh::Face_index, int> patch;  // kOther for faces that are not resampled now
  Mesh::Property_map<Mesh::Edge_index, bool> kept;
  std::vector<Mesh::Face_index> faces;
};
constexpr int kOther = -1;

Turn turn_of(FanMesh& fans, const std::vector<double>& edge_length, double length) {
  auto& mesh = fans.mesh;
  Turn turn;
  turn.patch = mesh.add_property_map<Mesh::Face_index, int>("f:turn", kOther).first;
  turn.kept = mesh.add_property_map<Mesh::Edge_index, bool>("e:turn", false).first;
  for (const Mesh::Face_index face : mesh.faces()) {
    turn.patch[face] = kOther;
    if (edge_length[static_cast<std::size_t>(fans.patch[face])] != length) continue;
    turn.patch[face] = fans.patch[face];
    turn.faces.push_back(face);
  }
  for (const Mesh::Edge_index edge : mesh.edges()) turn.kept[edge] = false;
  for (const Mesh::Face_index face : turn.faces) {
    for (const Mesh::Halfedge_index half : mesh.halfedges_around_face(mesh.halfedge(face))) {
      turn.kept[mesh.edge(half)] = fans.kept[mesh.edge(half)];
    }
  }
  return turn;
}

// Whether every kept edge is at most 4/3 of the length. Only then does CGAL guarantee that
// remeshing ends; it checks this only where its assertions are compiled in.
bool kept_are_short(const FanMesh& fans, const Turn& turn, double length) {
  const double longest = 4.0 / 3.0 * length * (1.0 + 1e-9);
  return std::ranges::all_of(fans.mesh.edges(), [&](Mesh::Edge_index edge) {
    if (!turn.kept[edge]) return true;
    const auto& a = fans.mesh.point(fans.mesh.vertex(edge, 0));
    const auto& b = fans.mesh.point(fans.mesh.vertex(edge, 1));
    return CGAL::squared_distance(a, b) <= longest * longest;
  });
}

// Resamples the patches of one edge length. False where kept edges are too long for this length.
bool resample(FanMesh& fans, const std::vector<double>& edge_length, double length) {
  Turn turn = turn_of(fans, edge_length, length);
  const bool short_enough = kept_are_short(fans, turn, length);
  if (short_enough) {
    pmp::isotropic_remeshing(turn.faces, length, fans.mesh,
                             CGAL::parameters::number_of_iterations(5)
                                 .number_of_relaxation_steps(3)
                                 .protect_constraints(true)
                                 .edge_is_constrained_map(turn.kept)
                                 .face_patch_map(turn.patch));
    for (const Mesh::Face_index face : fans.mesh.faces()) {
      if (turn.patch[face] != kOther) fans.patch[face] = turn.patch[face];
    }
  }
  fans.mesh.remove_property_map(turn.patch);
  fans.mesh.remove_property_map(turn.kept);
  return short_enough;
}

// The points of the result, and their numbers.
struct Numbered {
  std::vector<Eigen::RowVector3d> points;
  std::vector<int> of_vertex;    // of CGAL's mesh
  std::map<int, int> of_origin;  // of the points of the surface that stay

  // A point of the surface that stays where it is.
  int stays(int origin, const Surface& surface) {
    const auto [known, is_new] = of_origin.try_emplace(origin, static_cast<int>(points.size()));
    if (is_new) points.emplace_back(surface.points.row(origin));
    return known->second;
  }
};

// All fans at a point on a kept edge share this point again.
Numbered numbered(const FanMesh& fans, const Surface& before) {
  std::vector<char> fixed(fans.mesh.number_of_vertices() + fans.mesh.number_of_removed_vertices());
  for (const Mesh::Edge_index edge : fans.mesh.edges()) {
    if (!fans.kept[edge]) continue;
    fixed[fans.mesh.vertex(edge, 0)] = fixed[fans.mesh.vertex(edge, 1)] = 1;
  }
  Numbered result;
  result.of_vertex.assign(fixed.size(), -1);
  for (const Mesh::Vertex_index v : fans.mesh.vertices()) {
    if (fans.mesh.is_isolated(v)) continue;
    if (fixed[v] == 1 && fans.origin[v] >= 0) {
      result.of_vertex[v] = result.stays(fans.origin[v], before);
      continue;
    }
    result.of_vertex[v] = static_cast<int>(result.points.size());
    const Point& p = fans.mesh.point(v);
    result.points.emplace_back(p.x(), p.y(), p.z());
  }
  return result;
}

// Converts back to a surface, with the triangles that were not resampled behind the others.
Surface surface_of(const FanMesh& fans, const Surface& before,
                   const std::vector<bool>& is_resampled) {
  Numbered number = numbered(fans, before);
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<int> patch;
  for (const Mesh::Face_index face : fans.mesh.faces()) {
    Eigen::RowVector3i corners;
    int k = 0;
    for (const Mesh::Vertex_index v : fans.mesh.vertices_around_face(fans.mesh.halfedge(face))) {
      corners[k++] = number.of_vertex[v];
    }
    triangles.push_back(corners);
    patch.push_back(fans.patch[face]);
  }
  for (Eigen::Index t = 0; t < before.triangles.rows(); ++t) {
    if (is_resampled[static_cast<std::size_t>(t)]) continue;
    Eigen::RowVector3i corners;
    for (int k = 0; k < 3; ++k) corners[k] = number.stays(before.triangles(t, k), before);
    triangles.push_back(corners);
    patch.push_back(before.patch[t]);
  }
  Surface after;
  after.patch_names = before.patch_names;
  after.regions = before.regions;
  after.points.resize(static_cast<Eigen::Index>(number.points.size()), 3);
  for (std::size_t i = 0; i < number.points.size(); ++i) {
    after.points.row(static_cast<Eigen::Index>(i)) = number.points[i];
  }
  after.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    after.triangles.row(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  after.patch = Eigen::Map<const Eigen::VectorXi>(patch.data(), std::ssize(patch));
  return after;
}

}  // namespace

std::vector<Crossing> crossings(const Surface& surface) {
  const CgalQuiet quiet;
  std::vector<Crossing> found;
  const std::vector<Box> boxes = boxes_of(surface);
  std::vector<const Box*> pointers;
  for (const Box& box : boxes) pointers.push_back(&box);
  CGAL::box_self_intersection_d(pointers.begin(), pointers.end(), [&](const Box* a, const Box* b) {
    const int first = std::min(a->info(), b->info());
    const int second = std::max(a->info(), b->info());
    if (cross(surface, first, second)) found.push_back({first, second, middle_of_overlap(*a, *b)});
  });
  std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return found;
}

std::vector<Eigen::Vector3i> filling(const Surface& surface, const std::vector<int>& loop) {
  const CgalQuiet quiet;
  std::vector<Point> polyline;
  for (const int i : loop) polyline.push_back(point(surface, i));
  std::vector<CGAL::Triple<int, int, int>> patch;
  pmp::triangulate_hole_polyline(polyline, std::back_inserter(patch));
  std::vector<Eigen::Vector3i> triangles;
  for (const auto& t : patch) {
    const auto at = [&](int i) { return loop[static_cast<std::size_t>(i)]; };
    triangles.emplace_back(at(t.first), at(t.second), at(t.third));
  }
  return triangles;
}

std::optional<Surface> isotropic(const Surface& surface, const std::vector<Eigen::Vector2i>& kept,
                                 const std::vector<double>& edge_length) {
  const CgalQuiet quiet;
  const std::vector<bool> is_resampled = resampled(surface, edge_length);
  std::optional<FanMesh> fans = fan_mesh(surface, kept, is_resampled);
  if (!fans) return std::nullopt;
  try {
    for (const double length : lengths_of(edge_length)) {
      if (!resample(*fans, edge_length, length)) return std::nullopt;
    }
  } catch (const CGAL::Failure_exception&) {
    return std::nullopt;
  }
  return surface_of(*fans, surface, is_resampled);
}

}  // namespace chladni::mesh
