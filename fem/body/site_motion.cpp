#include "fem/body/site_motion.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "base/error.h"
#include "base/text_stream.h"
#include "fem/attachment.h"
#include "fem/element.h"

namespace chladni::fem {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

constexpr int kSides = 48;  // of the polygon that stands for the disc
constexpr Eigen::Index kMostNodes = 1000;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a(2), a(1), a(2), 0.0, -a(0), -a(1), a(0), 0.0;
  return m;
}

void require_on(const mesh::TetMesh& body, const mesh::Site& site) {
  const auto count = mesh::face_nodes(body.order());
  require(site.nodes.size() == count && site.weights.size() == count &&
              site.nodes.minCoeff() >= 0 && site.nodes.maxCoeff() < body.node_count() &&
              std::abs(site.weights.sum() - 1.0) < 1e-6 && site.position.allFinite(),
          "the site is not on a face of this body; find it with a SiteFinder of the same mesh");
}

// Whether the three corners of the site's face are corners of the tetrahedron.
bool has_face(const mesh::TetMesh& body, Eigen::Index tet, const mesh::Site& site) {
  const auto corners = body.tets.row(tet).head<4>();
  const auto has = [&](int node) { return (corners.array() == node).any(); };
  return has(site.nodes(0)) && has(site.nodes(1)) && has(site.nodes(2));
}

// Barycentric coordinates of the site in tetrahedron `tet`. The face's barycentric coordinates are
// linear, so the site's weights (shape functions) reproduce them.
Eigen::Vector4d barycentric_in(const mesh::TetMesh& body, const mesh::Site& site,
                               Eigen::Index tet) {
  const Eigen::Vector3d in_face =
      mesh::triangle_node_barycentric(body.order()).transpose() * site.weights;
  Eigen::Vector4d in_tet = Eigen::Vector4d::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    for (int i = 0; i < 4; ++i) {
      if (body.tets(tet, i) == site.nodes(corner)) in_tet(i) = in_face(corner);
    }
  }
  return in_tet;
}

// The disc in its own plane. Lengths are in radii; the site is the origin.
struct Disc {
  Eigen::Vector3d centre;
  Eigen::Matrix<double, 2, 3> axes;
  Eigen::Vector3d normal;
  double radius = 0.0;
  Polygon rim;  // counter-clockwise, of area π

  [[nodiscard]] Eigen::Vector2d seen(const Eigen::Vector3d& point) const {
    return axes * (point - centre) / radius;
  }
};

// The first axis follows the first edge of the face, so that the polygon turns with the body.
Disc disc_at(const mesh::TetMesh& body, const mesh::Site& site, double diameter) {
  Disc disc{.centre = site.position,
            .axes = {},
            .normal = site.normal.normalized(),
            .radius = 0.5 * diameter,
            .rim = {}};
  const Eigen::Vector3d edge =
      (body.points.row(site.nodes(1)) - body.points.row(site.nodes(0))).transpose();
  const Eigen::Vector3d first = (edge - disc.normal.dot(edge) * disc.normal).normalized();
  disc.axes.row(0) = first.transpose();
  disc.axes.row(1) = disc.normal.cross(first).transpose();
  const double angle = 2.0 * std::numbers::pi / kSides;
  const double reach = std::sqrt(angle / std::sin(angle));
  for (int i = 0; i < kSides; ++i) {
    disc.rim.emplace_back(reach * std::cos(i * angle), reach * std::sin(i * angle));
  }
  return disc;
}

// The part of `polygon` within the convex `window` (Sutherland and Hodgman 1974).
Polygon clipped(Polygon polygon, const Polygon& window) {
  for (std::size_t k = 0; k < window.size() && !polygon.empty(); ++k) {
    const Eigen::Vector2d from = window[k];
    const Eigen::Vector2d along = window[(k + 1) % window.size()] - from;
    const auto left = [&](const Eigen::Vector2d& p) {
      return along.x() * (p.y() - from.y()) - along.y() * (p.x() - from.x());
    };
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto& p = polygon[i];
      const auto& q = polygon[(i + 1) % polygon.size()];
      const double a = left(p);
      const double b = left(q);
      if (a >= 0.0) kept.push_back(p);
      if ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0))
        kept.emplace_back(p + a / (a - b) * (q - p));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

// Six points, exact to degree 4 (Dunavant 1985): barycentric coordinates and weights.
struct RulePoint {
  Eigen::Vector3d at;
  double weight;
};
std::array<RulePoint, 6> triangle_rule() {
  std::array<RulePoint, 6> rule{};
  constexpr std::array<double, 2> a{0.445948490915965, 0.091576213509771};
  constexpr std::array<double, 2> w{0.223381589678011, 0.109951743655322};
  for (std::size_t orbit = 0; orbit < 2; ++orbit) {
    for (std::size_t i = 0; i < 3; ++i) {
      auto& point = rule[3 * orbit + i];
      point.at = Eigen::Vector3d::Constant(a[orbit]);
      point.at(static_cast<Eigen::Index>(i)) = 1.0 - 2.0 * a[orbit];
      point.weight = w[orbit];
    }
  }
  return rule;
}

// A point of the surface within the disc, with its share of the area.
struct Sample {
  Eigen::Index face = 0;
  Eigen::VectorXd shape;
  Eigen::Vector3d arm;  // from the site [m]
  double area = 0.0;
  double seen = 0.0;  // of `area`, in the plane of the disc
};

// A face's corners projected on the disc, and the map back to the face's barycentric coordinates.
struct SeenFace {
  Polygon corners;
  Eigen::Matrix2d to_barycentric;
  double stretch = 0.0;  // true area per projected area

  [[nodiscard]] Eigen::Vector3d barycentric(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d l = to_barycentric * (p - corners[0]);
    return {1.0 - l.sum(), l(0), l(1)};
  }
};

// Projects the face on the disc. False where the face has another orientation or cannot reach the
// disc.
bool sees(const Disc& disc, const mesh::TetMesh& body, Eigen::Index face, SeenFace& seen) {
  seen.corners.clear();
  std::array<Eigen::Vector3d, 3> at;
  for (std::size_t i = 0; i < 3; ++i) {
    at[i] = body.points.row(body.faces(face, static_cast<Eigen::Index>(i))).transpose();
    seen.corners.push_back(disc.seen(at[i]));
  }
  const auto& c = seen.corners;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::min({c[0](axis), c[1](axis), c[2](axis)}) > 1.1) return false;
    if (std::max({c[0](axis), c[1](axis), c[2](axis)}) < -1.1) return false;
  }
  const double facing =
      (at[1] - at[0]).cross(Eigen::Vector3d(at[2] - at[0])).normalized().dot(disc.normal);
  if (!(facing > 0.5)) return false;
  Eigen::Matrix2d edges;
  edges << c[1] - c[0], c[2] - c[0];
  seen.to_barycentric = edges.inverse();
  seen.stretch = disc.radius * disc.radius / facing;
  return true;
}

void sample(const Disc& disc, const mesh::TetMesh& body, Eigen::Index face, const SeenFace& seen,
            std::vector<Sample>& samples) {
  static const auto rule = triangle_rule();
  const auto part = clipped(seen.corners, disc.rim);
  for (std::size_t i = 2; i < part.size(); ++i) {
    const Eigen::Vector2d a = part[i - 1] - part[0];
    const Eigen::Vector2d b = part[i] - part[0];
    const double area = 0.5 * (a.x() * b.y() - a.y() * b.x()) * seen.stretch;
    if (!(area > 0.0)) continue;
    for (const auto& point : rule) {
      const Eigen::Vector2d p = part[0] + point.at(1) * a + point.at(2) * b;
      Sample s{.face = face,
               .shape = mesh::triangle_shape(body.order(), seen.barycentric(p)),
               .arm = -disc.centre,
               .area = point.weight * area,
               .seen = point.weight * area * disc.radius * disc.radius / seen.stretch};
      for (Eigen::Index k = 0; k < s.shape.size(); ++k) {
        s.arm += s.shape(k) * body.points.row(body.faces(face, k)).transpose();
      }
      if (std::abs(s.arm.dot(disc.normal)) <= disc.radius) samples.push_back(std::move(s));
    }
  }
}

std::vector<Sample> samples_within(const Disc& disc, const mesh::TetMesh& body) {
  std::vector<Sample> samples;
  SeenFace seen;
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    if (sees(disc, body, f, seen)) sample(disc, body, f, seen, samples);
  }
  return samples;
}

// Local number of each node that the samples touch, in the order of the nodes.
std::map<int, Eigen::Index> numbered_nodes(const mesh::TetMesh& body,
                                           const std::vector<Sample>& samples) {
  std::map<int, Eigen::Index> local;
  for (const auto& s : samples) {
    for (const auto node : body.faces.row(s.face)) local.emplace(node, 0);
  }
  Eigen::Index next = 0;
  for (auto& entry : local) entry.second = next++;
  return local;
}

// The rigid motion nearest to the samples: with c the centroid and r = x − c,
// θ = J⁻¹ Σ a r × u,  J = Σ a (|r|² 1 − r rᵀ),  u(site) = Σ a u / Σ a − θ × c.
SiteMotion nearest_rigid_motion(const mesh::TetMesh& body, const std::vector<Sample>& samples,
                                const std::map<int, Eigen::Index>& local) {
  double area = 0.0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const auto& s : samples) {
    area += s.area;
    centroid += s.area * s.arm;
  }
  centroid /= area;
  SiteMotion motion;
  motion.nodes.resize(static_cast<Eigen::Index>(local.size()));
  for (const auto& [node, k] : local) motion.nodes(k) = node;
  motion.displacement.setZero(3, 3 * motion.nodes.size());
  motion.rotation.setZero(3, 3 * motion.nodes.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& s : samples) {
    const Eigen::Vector3d r = s.arm - centroid;
    const Eigen::Matrix3d arm = cross_matrix(r);
    spread -= s.area * arm * arm;
    for (Eigen::Index a = 0; a < s.shape.size(); ++a) {
      const auto column = 3 * local.at(body.faces(s.face, a));
      motion.rotation.middleCols<3>(column) += s.area * s.shape(a) * arm;
      motion.displacement.middleCols<3>(column).diagonal().array() += s.area / area * s.shape(a);
    }
  }
  motion.rotation = spread.ldlt().solve(motion.rotation).eval();
  motion.displacement += cross_matrix(centroid) * motion.rotation;
  return motion;
}

}  // namespace

std::vector<Eigen::Index> tets_below(const mesh::TetMesh& body,
                                     const std::vector<mesh::Site>& sites) {
  std::vector<Eigen::Index> below(sites.size(), -1);
  // Sites are listed under the first corner of their face. A tetrahedron with this corner may hold
  // the site.
  std::vector<char> is_first(static_cast<std::size_t>(body.node_count()), 0);
  std::unordered_multimap<int, std::size_t> site_of;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const auto& nodes = sites[i].nodes;
    if (nodes.size() < 3 || nodes(0) < 0 || nodes(0) >= body.node_count()) continue;
    is_first[static_cast<std::size_t>(nodes(0))] = 1;
    site_of.emplace(nodes(0), i);
  }
  for (Eigen::Index t = 0; t < body.tet_count() && !site_of.empty(); ++t) {
    for (const auto corner : body.tets.row(t).head<4>()) {
      if (is_first[static_cast<std::size_t>(corner)] == 0) continue;
      const auto [begin, end] = site_of.equal_range(corner);
      for (auto site = begin; site != end; ++site) {
        if (below[site->second] < 0 && has_face(body, t, sites[site->second]))
          below[site->second] = t;
      }
    }
  }
  return below;
}

SiteMotion point_motion(const mesh::TetMesh& body, const mesh::Site& site, Eigen::Index tet) {
  require_on(body, site);
  require(tet >= 0 && tet < body.tet_count() && has_face(body, tet, site),
          "the site's face belongs to no tetrahedron of this body");
  const auto values = shape(element(body.order()), barycentric_in(body, site, tet));
  const auto count = body.tets.cols();
  SiteMotion motion{.nodes = body.tets.row(tet).transpose(),
                    .displacement = Eigen::Matrix3Xd::Zero(3, 3 * count),
                    .rotation = Eigen::Matrix3Xd::Zero(3, 3 * count)};
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    points.col(a) = body.points.row(motion.nodes(a)).transpose();
  }
  // J_ij = ∂x_i/∂ξ_j; half the curl of Σ N_a u_a is ½ Σ ∇N_a × u_a.
  const Eigen::Matrix3d jacobian = points * values.gradient;
  const Eigen::MatrixXd gradient = values.gradient * jacobian.inverse();
  for (Eigen::Index a = 0; a < count; ++a) {
    motion.rotation.middleCols<3>(3 * a) = 0.5 * cross_matrix(gradient.row(a).transpose());
    for (Eigen::Index k = 0; k < site.nodes.size(); ++k) {
      if (site.nodes(k) != motion.nodes(a)) continue;
      motion.displacement.middleCols<3>(3 * a).diagonal().setConstant(site.weights(k));
    }
  }
  return motion;
}

SiteMotion footprint_motion(const mesh::TetMesh& body, const mesh::Site& site, double diameter) {
  require_on(body, site);
  const double size = (body.points.row(site.nodes(1)) - body.points.row(site.nodes(0))).norm();
  TextWriter found;
  found << "the footprint is " << diameter << " m across";
  require(std::isfinite(diameter) && diameter > 1e-6 * size,
          found.str() +
              "; expected a diameter of more than 1e-6 of the mesh's edges, or 0 for a point");
  const auto disc = disc_at(body, site, diameter);
  const auto samples = samples_within(disc, body);
  const auto local = numbered_nodes(body, samples);
  const auto nodes = static_cast<Eigen::Index>(local.size());
  found << " and takes in " << nodes << " nodes of the mesh";
  require(nodes > 0, found.str() + "; the site's normal does not fit its face");
  require(nodes <= kMostNodes, found.str() + ", which would all be coupled; expected at most " +
                                   fmt::to_string(kMostNodes) +
                                   ": use several attachments with smaller footprints");
  return nearest_rigid_motion(body, samples, local);
}

double footprint_on_body(const mesh::TetMesh& body, const mesh::Site& site, double diameter) {
  if (!(diameter > 0.0)) return 1.0;
  const auto disc = disc_at(body, site, diameter);
  double seen = 0.0;
  for (const auto& sample : samples_within(disc, body)) seen += sample.seen;
  return std::min(1.0, seen / (std::numbers::pi * disc.radius * disc.radius));
}

}  // namespace chladni::fem
