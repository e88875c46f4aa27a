// Discs: rings of triangles, extruded to layers of prisms.
#include "mesh/disc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "mesh/shapes/body_checks.h"

namespace chladni::mesh {
namespace {

constexpr double kPi = std::numbers::pi;

// The pattern is that of a 12-sided polygon with mirror lines every 15 degrees. So modes of n nodal
// diameters stay in pairs unless n is a multiple of 6.
constexpr int kSectors = 12;
constexpr int kFewest = 2 * kSectors;  // nodes of the smallest ring
constexpr double kMostTets = 1e7;

// A flat triangulation. Its symmetries map the triangles and `rank` onto themselves. The two ends
// of every edge differ in rank.
struct Rings {
  std::vector<Eigen::Vector2d> points;
  std::vector<int> rank;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise
  std::vector<int> hole, rim;                 // nodes, counter-clockwise; no hole: empty
};

// Corner radius of a regular polygon of n corners with the area of the circle.
double corner_radius(double radius, int n) {
  const double angle = 2.0 * kPi / n;
  return radius * std::sqrt(angle / std::sin(angle));
}

// Number of steps from node j of n to the nearest mirror line through nodes of all rings.
int folded(int j, int n) {
  const int period = n / kSectors;
  const int k = ((j % period) + period) % period;
  return std::min(k, period - k);
}

// The point at angle 2π j / n. It is computed in one eighth of the circle and mirrored, so mirrored
// points agree to the last bit.
Eigen::Vector2d on_circle(int j, int n) {
  const int eighth = n / 8;
  const int octant = j / eighth;
  const int k = octant % 2 == 0 ? j % eighth : eighth - j % eighth;
  const double c = std::cos(2.0 * kPi * k / n);
  const double s = std::sin(2.0 * kPi * k / n);
  switch (octant) {
    case 0:
      return {c, s};
    case 1:
      return {s, c};
    case 2:
      return {-s, c};
    case 3:
      return {-c, s};
    case 4:
      return {-c, -s};
    case 5:
      return {-s, -c};
    case 6:
      return {s, -c};
    default:
      return {c, -s};
  }
}

std::vector<int> add_ring(Rings& rings, double radius, int n, int ring) {
  std::vector<int> nodes;
  for (int j = 0; j < n; ++j) {
    nodes.push_back(static_cast<int>(rings.points.size()));
    rings.points.emplace_back(radius * on_circle(j, n));
    rings.rank.push_back(100000 * ring + folded(j, n));
  }
  return nodes;
}

// Joins two rings with equal numbers of nodes by quadrilaterals. Each is cut in two triangles, and
// mirrored quadrilaterals get mirrored cuts.
void join_equal(Rings& rings, const std::vector<int>& in, const std::vector<int>& out, int ring) {
  const int n = static_cast<int>(in.size());
  for (int j = 0; j < n; ++j) {
    const auto a = static_cast<std::size_t>(j);
    const auto b = static_cast<std::size_t>((j + 1) % n);
    const int lower = std::min(folded(j, n), folded(j + 1, n));
    const bool from_a = (folded(j, n) < folded(j + 1, n)) == ((lower + ring) % 2 == 0);
    if (from_a) {
      rings.triangles.push_back({in[a], out[a], out[b]});
      rings.triangles.push_back({in[a], out[b], in[b]});
    } else {
      rings.triangles.push_back({in[a], out[a], in[b]});
      rings.triangles.push_back({in[b], out[a], out[b]});
    }
  }
}

// Joins a ring to an outer ring with twice as many nodes: three triangles per inner edge.
void join_doubled(Rings& rings, const std::vector<int>& in, const std::vector<int>& out) {
  for (std::size_t j = 0; j < in.size(); ++j) {
    const std::size_t next = (j + 1) % in.size();
    rings.triangles.push_back({in[j], out[2 * j], out[2 * j + 1]});
    rings.triangles.push_back({in[j], out[2 * j + 1], in[next]});
    rings.triangles.push_back({in[next], out[2 * j + 1], out[2 * next]});
  }
}

// How far the circle is off the middle of one of n edges.
double rise(double radius, int n) { return 2.0 * radius * std::pow(std::sin(0.5 * kPi / n), 2); }

// Whether n nodes on a ring of `radius` are too few: their edges are too long, or the curved edges
// of a wall of this ring and the next, `step` apart, bend over the straight edges between the two.
bool too_few(double radius, int n, double step, double edge_length) {
  constexpr double kLeastSteps = 8.0;  // half of what would turn a cell over
  return 2.0 * kPi * radius / n > 1.4 * edge_length || kLeastSteps * rise(radius, n) > step;
}

// The numbers of nodes of all rings, from the hole (or the centre: 1) to the rim.
std::vector<int> nodes_of_rings(const Disc& disc, double edge_length) {
  const double inner = disc.hole_diameter / 2.0;
  const double outer = disc.diameter / 2.0;
  const int count = cells_in(outer - inner, edge_length);
  const double step = (outer - inner) / count;
  std::vector<int> nodes;
  int n = kFewest;
  if (inner > 0.0) {
    while (n < kMostTets && too_few(inner, n, step, edge_length)) n *= 2;
  }
  nodes.push_back(inner > 0.0 ? n : 1);
  for (int r = 1; r <= count; ++r) {
    const double radius = inner + (outer - inner) * r / count;
    if (nodes.back() > 1 && n < kMostTets && too_few(radius, n, step, edge_length)) n *= 2;
    nodes.push_back(n);
  }
  return nodes;
}

Rings rings_of(const Disc& disc, const std::vector<int>& nodes) {
  const double inner = disc.hole_diameter / 2.0;
  const double outer = disc.diameter / 2.0;
  const int count = static_cast<int>(nodes.size()) - 1;
  Rings rings;
  std::vector<int> before;
  if (inner > 0.0) {
    before = rings.hole = add_ring(rings, corner_radius(inner, nodes[0]), nodes[0], 0);
  } else {
    rings.points.emplace_back(0.0, 0.0);
    rings.rank.push_back(0);
  }
  for (int r = 1; r <= count; ++r) {
    const double radius = inner + (outer - inner) * r / count;
    const int n = nodes[static_cast<std::size_t>(r)];
    const double to_corner = r == count ? corner_radius(radius, n) : radius;
    const std::vector<int> ring = add_ring(rings, to_corner, n, r);
    if (before.empty()) {
      for (std::size_t j = 0; j < ring.size(); ++j) {
        rings.triangles.push_back({0, ring[j], ring[(j + 1) % ring.size()]});
      }
    } else if (before.size() == ring.size()) {
      join_equal(rings, before, ring, r);
    } else {
      join_doubled(rings, before, ring);
    }
    before = ring;
  }
  rings.rim = before;
  return rings;
}

// Cuts a prism into three tetrahedra, by rising rank from the bottom to the top. Every second layer
// is turned over, so that neighbouring layers are mirror images.
void add_prism(std::vector<std::array<int, 4>>& tets, std::array<int, 3> triangle,
               const std::vector<int>& rank, int lower, int upper) {
  const std::array<int, 3> given = triangle;
  std::sort(triangle.begin(), triangle.end(), [&](int a, int b) {
    return rank[static_cast<std::size_t>(a)] < rank[static_cast<std::size_t>(b)];
  });
  const auto [a, b, c] = triangle;
  const bool even = (a == given[0] && b == given[1]) || (a == given[1] && b == given[2]) ||
                    (a == given[2] && b == given[0]);
  std::array<std::array<int, 4>, 3> three{{{lower + a, lower + b, lower + c, upper + c},
                                           {lower + a, upper + b, lower + b, upper + c},
                                           {lower + a, upper + a, upper + b, upper + c}}};
  for (auto& tet : three) {
    if (even == (lower > upper)) std::swap(tet[1], tet[2]);
    tets.push_back(tet);
  }
}

struct Face {
  std::array<int, 3> nodes;
  int patch;
};

// Adds the wall over a closed line of nodes: two triangles per edge and layer, cut as the prisms.
void add_wall(std::vector<Face>& faces, const std::vector<int>& line, const std::vector<int>& rank,
              int lower, int upper, int patch, bool inward) {
  for (std::size_t j = 0; j < line.size(); ++j) {
    int a = line[j];
    int b = line[(j + 1) % line.size()];
    bool flip = inward != (lower > upper);
    if (rank[static_cast<std::size_t>(a)] > rank[static_cast<std::size_t>(b)]) {
      std::swap(a, b);
      flip = !flip;
    }
    std::array<std::array<int, 3>, 2> two{
        {{lower + a, lower + b, upper + b}, {lower + a, upper + b, upper + a}}};
    for (auto& nodes : two) {
      if (flip) std::swap(nodes[1], nodes[2]);
      faces.push_back({nodes, patch});
    }
  }
}

template <std::size_t columns>
Cells cells_of(const std::vector<std::array<int, columns>>& rows) {
  Cells cells(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      cells(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c];
    }
  }
  return cells;
}

// The points of a flat plan, repeated at each layer from −thickness up to 0.
Points stacked(const std::vector<Eigen::Vector2d>& plan, double thickness, int layers) {
  const auto n = static_cast<Eigen::Index>(plan.size());
  Points points(n * (layers + 1), 3);
  for (int k = 0; k <= layers; ++k) {
    const double z = thickness * (k - layers) / layers;  // 0, not -0, on top
    for (Eigen::Index p = 0; p < n; ++p) {
      const Eigen::Vector2d& at = plan[static_cast<std::size_t>(p)];
      points.row(k * n + p) << at.x(), at.y(), z;
    }
  }
  return points;
}

// Value and derivative of Lagrange polynomial k on equidistant nodes of [−1, 1].
std::pair<double, double> lagrange(int order, int k, double at) {
  double value = 1.0;
  double derivative = 0.0;
  for (int j = 0; j <= order; ++j) {
    if (j == k) continue;
    const double apart = 2.0 * (k - j) / order;
    const double factor = (at + 1.0 - 2.0 * j / order) / apart;
    derivative = derivative * factor + value / apart;
    value *= factor;
  }
  return {value, derivative};
}

// Number of edges around a patch: the number of its corners in the plane z = 0.
int edges_around(const TetMesh& mesh, int patch) {
  std::set<std::int32_t> corners;
  const double level = 1e-6 * mesh.points.col(2).cwiseAbs().maxCoeff();
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    if (mesh.face_patch(f) != patch) continue;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(mesh.points(mesh.faces(f, k), 2)) < level) corners.insert(mesh.faces(f, k));
    }
  }
  return static_cast<int>(corners.size());
}

// A closed ring of n curved edges of `order`, whose nodes are equidistant on the chords and then
// moved radially onto the ring. Returns the ring's radius over the radius of a circle of the same
// area. The area is ½ ∮ x dy − y dx (three Gauss points per edge).
double radius_of_equal_area(int n, int order) {
  const double half = kPi / n;
  std::vector<Eigen::Vector2d> nodes;
  for (int k = 0; k <= order; ++k) {
    const double angle = std::atan(std::tan(half) * (2.0 * k / order - 1.0));
    nodes.emplace_back(std::cos(angle), std::sin(angle));
  }
  double twice = 0.0;
  for (const double at : {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}) {
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    for (int k = 0; k <= order; ++k) {
      const auto [value, derivative] = lagrange(order, k, at);
      point += value * nodes[static_cast<std::size_t>(k)];
      slope += derivative * nodes[static_cast<std::size_t>(k)];
    }
    twice += (at == 0.0 ? 8.0 : 5.0) / 9.0 * (point.x() * slope.y() - point.y() * slope.x());
  }
  return std::sqrt(kPi / (0.5 * n * twice));
}

void put_faces(TetMesh& mesh, const std::vector<Face>& faces) {
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  mesh.face_patch.resize(mesh.faces.rows());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& [a, b, c] = faces[f].nodes;
    mesh.faces.row(static_cast<Eigen::Index>(f)) << a, b, c;
    mesh.face_patch(static_cast<Eigen::Index>(f)) = faces[f].patch;
  }
}

}  // namespace

TetMesh layered(const Disc& disc, const Layering& layering) {
  require_fit(disc);
  require_fit(layering);
  const auto nodes = nodes_of_rings(disc, layering.edge_length);
  double triangles = 0.0;
  for (std::size_t r = 1; r < nodes.size(); ++r)
    triangles += static_cast<double>(nodes[r - 1]) + nodes[r];
  require(3.0 * triangles * layering.layers < kMostTets,
          "mesh: the edge length makes more than 10 million tetrahedra of the disc; take a longer "
          "one, or look at the unit of the dimensions");
  const Rings rings = rings_of(disc, nodes);
  const int n = static_cast<int>(rings.points.size());
  std::vector<std::array<int, 4>> tets;
  std::vector<Face> faces;
  for (int k = 0; k < layering.layers; ++k) {
    const int lower = (k + k % 2) * n;
    const int upper = (k + 1 - k % 2) * n;
    for (const auto& triangle : rings.triangles) {
      add_prism(tets, triangle, rings.rank, lower, upper);
    }
    add_wall(faces, rings.rim, rings.rank, lower, upper, 2, false);
    add_wall(faces, rings.hole, rings.rank, lower, upper, 3, true);
  }
  const int top = layering.layers * n;
  for (const auto& [a, b, c] : rings.triangles) {
    faces.push_back({{top + a, top + b, top + c}, 0});
    faces.push_back({{a, c, b}, 1});
  }
  TetMesh mesh;
  mesh.points = stacked(rings.points, disc.thickness, layering.layers);
  mesh.tets = cells_of(tets);
  mesh.region = Eigen::VectorXi::Zero(mesh.tets.rows());
  mesh.region_names = {"body"};
  put_faces(mesh, faces);
  mesh.patch_names = {"top", "bottom", "rim"};
  if (!rings.hole.empty()) mesh.patch_names.emplace_back("hole");
  return mesh;
}

void project_to_disc(TetMesh& mesh, const Disc& disc, int order) {
  require_fit(disc);
  for (const std::string patch : {"rim", "hole"}) {
    const auto found = std::find(mesh.patch_names.begin(), mesh.patch_names.end(), patch);
    if (found == mesh.patch_names.end()) continue;
    const auto number = static_cast<int>(found - mesh.patch_names.begin());
    const double radius = (patch == "rim" ? disc.diameter : disc.hole_diameter) / 2.0 *
                          radius_of_equal_area(edges_around(mesh, number), order);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      if (mesh.face_patch(f) != number) continue;
      for (const std::int32_t node : mesh.faces.row(f)) {
        auto at = mesh.points.row(node).head<2>();
        at *= radius / at.norm();
      }
    }
  }
}

Surface surface(const Disc& disc, double edge_length) {
  require_fit(disc);
  require_positive("disc", "edge length", edge_length);
  const int layers = std::min(1000, cells_in(disc.thickness, edge_length));
  return boundary_surface(layered(disc, Layering{.edge_length = edge_length, .layers = layers}));
}

}  // namespace chladni::mesh
