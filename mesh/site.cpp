#include "mesh/site.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "base/error.h"
#include "mesh/tets/triangle.h"

namespace chladni::mesh {
namespace {

using Box = Eigen::AlignedBox3d;

FaceNodes nodes_of(const TetMesh& mesh, Eigen::Index face) {
  FaceNodes nodes(mesh.faces.cols(), 3);
  for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
    nodes.row(a) = mesh.points.row(mesh.faces(face, a));
  }
  return nodes;
}

Site site_at(const TetMesh& mesh, Eigen::Index face, const Eigen::Vector3d& barycentric,
             const Eigen::Vector3d& asked) {
  const FaceNodes nodes = nodes_of(mesh, face);
  const FaceShape shape = face_shape(mesh.order(), barycentric);
  const Eigen::Matrix3d slope = nodes.transpose() * shape.by_barycentric;
  Eigen::Vector3d normal = (slope.col(1) - slope.col(0)).cross(slope.col(2) - slope.col(0));
  const double size = normal.norm();
  Site site;
  site.nodes = mesh.faces.row(face).transpose();
  site.weights = shape.value;
  site.position = nodes.transpose() * shape.value;
  site.normal = size > 0.0 ? Eigen::Vector3d(normal / size) : Eigen::Vector3d::UnitZ();
  site.face = face;
  site.distance = (site.position - asked).norm();
  return site;
}

// Whether `site` is the nearer one to a vertical line; of equally near ones the higher, then the
// one on the face that looks up.
bool is_rather(const Site& site, const Site& other, double slack) {
  const double nearer = other.distance - site.distance;
  if (std::abs(nearer) > slack) return nearer > 0.0;
  const double higher = site.position.z() - other.position.z();
  if (std::abs(higher) > slack) return higher > 0.0;
  const double up = site.normal.z() - other.normal.z();
  if (std::abs(up) > 1e-9) return up > 0.0;
  return site.face < other.face;
}

}  // namespace

// A tree of boxes around faces. Each box is halved at the median along its longest side. The
// children of a node are `left` and left + 1.
struct SiteFinder::Tree {
  struct Node {
    Box box{};
    std::int32_t left = -1;           // −1: a leaf
    std::int32_t begin = 0, end = 0;  // its faces, in `faces`
  };
  const TetMesh* mesh;
  std::vector<std::int32_t> faces;  // face numbers, leaf by leaf
  std::vector<bool> curved;         // per face
  std::vector<Box> boxes;           // per face, with all of its nodes
  std::vector<Node> nodes;

  explicit Tree(const TetMesh& of);
  void split(std::size_t node);
  /// The point where the vertical line meets a face that faces up.
  [[nodiscard]] std::optional<Site> crossing(std::int32_t face, double x, double y) const;
  template <typename Away, typename Visit>
  void descend(const Away& away, const Visit& visit) const;
};

SiteFinder::Tree::Tree(const TetMesh& of) : mesh(&of) {
  require(of.faces.rows() > 0,
          "sites: the mesh has no boundary faces, expected those of mesh::find_boundary");
  require(of.faces.minCoeff() >= 0 && of.faces.maxCoeff() < of.points.rows(),
          "sites: a boundary face names a point that is not there; see mesh::check");
  const auto count = static_cast<std::size_t>(of.faces.rows());
  faces.resize(count);
  std::iota(faces.begin(), faces.end(), 0);
  for (std::size_t f = 0; f < count; ++f) {
    const FaceNodes at = nodes_of(of, static_cast<Eigen::Index>(f));
    Box box;
    for (const auto p : at.rowwise()) box.extend(p.transpose());
    const double off = sag(at, of.order());
    curved.push_back(off > 1e-9 * box.diagonal().norm());
    // A cubic face bulges beyond its nodes by less than the nodes' distance from the plane.
    if (curved.back()) {
      box.min().array() -= off;
      box.max().array() += off;
    }
    boxes.push_back(box);
  }
  nodes.push_back({.begin = 0, .end = static_cast<std::int32_t>(count)});
  for (std::size_t n = 0; n < nodes.size(); ++n) split(n);
}

void SiteFinder::Tree::split(std::size_t node) {
  constexpr std::int32_t kLeaf = 4;
  const auto [begin, end] = std::pair(nodes[node].begin, nodes[node].end);
  Box centres;
  for (std::int32_t i = begin; i < end; ++i) {
    const Box& box = boxes[static_cast<std::size_t>(faces[static_cast<std::size_t>(i)])];
    nodes[node].box.extend(box);
    centres.extend(box.center());
  }
  if (end - begin <= kLeaf) return;
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(faces.begin() + begin, faces.begin() + middle, faces.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     const double x = boxes[static_cast<std::size_t>(a)].center()(axis);
                     const double y = boxes[static_cast<std::size_t>(b)].center()(axis);
                     return x < y || (x == y && a < b);
                   });
  nodes[node].left = static_cast<std::int32_t>(nodes.size());
  nodes.push_back({.begin = begin, .end = middle});
  nodes.push_back({.begin = middle, .end = end});
}

// Visits the faces of all leaves whose boxes may matter. `away` gives the squared distance of a
// box. `visit` returns the largest squared distance that still matters; boxes beyond this distance
// are skipped. The nearer half comes first.
template <typename Away, typename Visit>
void SiteFinder::Tree::descend(const Away& away, const Visit& visit) const {
  double reach = HUGE_VAL;
  std::vector<std::pair<double, std::int32_t>> open{{away(nodes[0].box), 0}};
  while (!open.empty()) {
    const auto [distance, number] = open.back();
    open.pop_back();
    if (distance > reach) continue;
    const Node& node = nodes[static_cast<std::size_t>(number)];
    if (node.left < 0) {
      for (std::int32_t i = node.begin; i < node.end; ++i) {
        reach = visit(faces[static_cast<std::size_t>(i)]);
      }
      continue;
    }
    const auto& left = nodes[static_cast<std::size_t>(node.left)];
    const auto& right = nodes[static_cast<std::size_t>(node.left) + 1];
    const double to_left = away(left.box);
    const double to_right = away(right.box);
    open.emplace_back(std::max(to_left, to_right), node.left + (to_left > to_right ? 0 : 1));
    open.emplace_back(std::min(to_left, to_right), node.left + (to_left > to_right ? 1 : 0));
  }
}

SiteFinder::SiteFinder(const TetMesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
SiteFinder::~SiteFinder() = default;
SiteFinder::SiteFinder(SiteFinder&&) noexcept = default;
SiteFinder& SiteFinder::operator=(SiteFinder&&) noexcept = default;

Site SiteFinder::nearest(const Eigen::Vector3d& point) const {
  require(point.allFinite(), "sites: the point asked for is not finite");
  const TetMesh& mesh = *tree_->mesh;
  double least = HUGE_VAL;
  std::int32_t best = -1;
  Eigen::Vector3d best_at = Eigen::Vector3d::Zero();
  const auto away = [&](const Box& box) { return box.squaredExteriorDistance(point); };
  tree_->descend(away, [&](std::int32_t face) {
    const FaceNodes nodes = nodes_of(mesh, face);
    const bool curved = tree_->curved[static_cast<std::size_t>(face)];
    const Eigen::Vector3d at = curved ? nearest_on_face(nodes, mesh.order(), point)
                                      : nearest_in_triangle(nodes.topRows<3>(), point);
    const Eigen::Vector3d here =
        curved ? Eigen::Vector3d(nodes.transpose() * face_shape(mesh.order(), at).value)
               : Eigen::Vector3d(nodes.topRows<3>().transpose() * at);
    const double distance = (here - point).squaredNorm();
    if (distance < least || (distance == least && face < best)) {
      least = distance;
      best = face;
      best_at = at;
    }
    return least;
  });
  return site_at(mesh, best, best_at, point);
}

std::optional<Site> SiteFinder::Tree::crossing(std::int32_t face, double x, double y) const {
  const VerticalCrossing at = vertical_crossing(nodes_of(*mesh, face), mesh->order(),
                                                curved[static_cast<std::size_t>(face)], {x, y});
  if (!at.found) return {};
  Site site = site_at(*mesh, face, at.barycentric, {x, y, 0.0});
  if (site.normal.z() <= 0.0) return {};  // seen from below
  site.distance = (site.position.head<2>() - Eigen::Vector2d(x, y)).norm();
  return site;
}

std::optional<Site> SiteFinder::from_above(double x, double y) const {
  require(std::isfinite(x) && std::isfinite(y), "sites: the point asked for is not finite");
  const double slack = 1e-9 * tree_->nodes[0].box.diagonal().norm();
  const auto over = [&](const Box& box) {
    return x >= box.min().x() - slack && x <= box.max().x() + slack && y >= box.min().y() - slack &&
           y <= box.max().y() + slack;
  };
  std::optional<Site> highest;
  std::vector<std::int32_t> open{0};
  while (!open.empty()) {
    const auto& node = tree_->nodes[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (!over(node.box)) continue;
    if (highest && node.box.max().z() < highest->position.z() - slack) continue;
    if (node.left >= 0) {
      open.insert(open.end(), {node.left, node.left + 1});
      continue;
    }
    for (std::int32_t i = node.begin; i < node.end; ++i) {
      const std::int32_t face = tree_->faces[static_cast<std::size_t>(i)];
      if (!over(tree_->boxes[static_cast<std::size_t>(face)])) continue;
      std::optional<Site> site = tree_->crossing(face, x, y);
      if (!site) continue;
      const double lead = highest ? site->position.z() - highest->position.z() : HUGE_VAL;
      const bool level = std::abs(lead) <= slack;
      if (lead > slack || (level && site->face < highest->face)) highest = std::move(site);
    }
  }
  return highest;
}

// The nearest point of a body that is squashed to the height 0 is the nearest one measured level. A
// little of the height is left, so that of the points of an upright face the highest is found.
Site SiteFinder::beside(double x, double y) const {
  constexpr double kHeightLeft = 1e-4;
  require(std::isfinite(x) && std::isfinite(y), "sites: the point asked for is not finite");
  const TetMesh& mesh = *tree_->mesh;
  const Box& whole = tree_->nodes[0].box;
  const double slack = 1e-9 * whole.diagonal().norm();
  const Eigen::Vector3d squashed(x, y, kHeightLeft * whole.max().z());
  const auto away = [&](Box box) {
    box.min().z() = -HUGE_VAL;
    box.max().z() = HUGE_VAL;
    return box.squaredExteriorDistance(squashed);
  };
  std::optional<Site> best;
  tree_->descend(away, [&](std::int32_t face) {
    FaceNodes nodes = nodes_of(mesh, face);
    nodes.col(2) *= kHeightLeft;
    Site site = site_at(mesh, face,
                        tree_->curved[static_cast<std::size_t>(face)]
                            ? nearest_on_face(nodes, mesh.order(), squashed)
                            : nearest_in_triangle(nodes.topRows<3>(), squashed),
                        squashed);
    site.distance = (site.position.head<2>() - squashed.head<2>()).norm();
    if (!best || is_rather(site, *best, slack)) best = std::move(site);
    return std::pow(best->distance + slack, 2);
  });
  return *best;
}

Eigen::SparseVector<double> row_at(const Site& site, const Eigen::Vector3d& direction,
                                   Eigen::Index node_count) {
  require(direction.allFinite() && std::abs(direction.norm() - 1.0) < 1e-6,
          "row_at: the direction has length " + fmt::to_string(direction.norm()) + ", expected 1");
  require(site.nodes.size() == site.weights.size() && site.nodes.size() > 0 &&
              site.nodes.minCoeff() >= 0 && site.nodes.maxCoeff() < node_count,
          "row_at: the site is not of a mesh with " + fmt::to_string(node_count) + " nodes");
  Eigen::SparseVector<double> row(3 * node_count);
  row.reserve(3 * site.nodes.size());
  for (Eigen::Index a = 0; a < site.nodes.size(); ++a) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      row.coeffRef(3 * site.nodes(a) + axis) += site.weights(a) * direction(axis);
    }
  }
  return row;
}

Eigen::VectorXd triangle_shape(int order, const Eigen::Vector3d& barycentric) {
  require(order >= 1 && order <= 3,
          "element order is " + fmt::to_string(order) + ", expected 1, 2 or 3");
  return face_shape(order, barycentric).value;
}

}  // namespace chladni::mesh
