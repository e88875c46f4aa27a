#include "mesh/tets/joints.h"

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <utility>

#include "mesh/disjoint_sets.h"
#include "mesh/numbering.h"

namespace chladni::mesh {
namespace {

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

using Pair = std::pair<std::int32_t, std::int32_t>;

// For each pair of parts, the nodes that they share.
std::map<Pair, std::vector<std::int32_t>> shared_nodes(const TetMesh& mesh, const Parts& parts) {
  // `more` holds pairs (node, part) for nodes of several parts, without the node's first part.
  std::vector<std::int32_t> first(at(mesh.node_count()), -1);
  std::vector<Pair> more;
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    const auto part = parts.of_cell[at(t)];
    for (const auto node : mesh.tets.row(t)) {
      auto& known = first[at(node)];
      if (known < 0) known = part;
      if (known != part) more.emplace_back(node, part);
    }
  }
  std::sort(more.begin(), more.end());
  more.erase(std::unique(more.begin(), more.end()), more.end());
  std::map<Pair, std::vector<std::int32_t>> shared;
  for (std::size_t begin = 0, end = 0; begin < more.size(); begin = end) {
    const auto node = more[begin].first;
    std::vector<std::int32_t> there{first[at(node)]};
    for (end = begin; end < more.size() && more[end].first == node; ++end) {
      there.push_back(more[end].second);
    }
    std::sort(there.begin(), there.end());
    for (std::size_t i = 0; i < there.size(); ++i) {
      for (std::size_t j = i + 1; j < there.size(); ++j) {
        shared[{there[i], there[j]}].push_back(node);
      }
    }
  }
  return shared;
}

Eigen::Matrix3Xd points_of(const TetMesh& mesh, const std::vector<std::int32_t>& nodes) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = mesh.points.row(nodes[i]).transpose();
  }
  return points;
}

// Whether the points lie on a line, with a tolerance of 1e-9 of the body's extent.
bool on_a_line(Eigen::Matrix3Xd points, double extent) {
  if (points.cols() < 3) return true;
  points.colwise() -= Eigen::Vector3d(points.rowwise().mean());
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(points);
  return svd.singularValues()(1) <= 1e-9 * extent;
}

// Joins parts that share three nodes not on a line, until there are no more such parts.
Parts joined(const TetMesh& mesh, Parts parts, double extent) {
  for (bool again = true; again && parts.count > 1;) {
    again = false;
    DisjointSets sets(at(parts.count));
    for (const auto& [pair, nodes] : shared_nodes(mesh, parts)) {
      if (on_a_line(points_of(mesh, nodes), extent)) continue;
      sets.join(at(pair.first), at(pair.second));
      again = true;
    }
    if (!again) break;
    const auto number = sets.numbers();
    for (auto& part : parts.of_cell) part = number[at(part)];
    parts.count = *std::max_element(number.begin(), number.end()) + 1;
  }
  return parts;
}

// Number of rigid motions of the parts that do not open the joints, less the six of the whole body.
// Rotations are about the middle; lengths are in units of `extent`.
int free_motions(const TetMesh& mesh, const std::vector<Joint>& joints, int parts, double extent) {
  Eigen::Index rows = 0;
  for (const auto& joint : joints) rows += 3 * static_cast<Eigen::Index>(joint.node.size());
  Eigen::MatrixXd apart = Eigen::MatrixXd::Zero(rows, 6 * Eigen::Index{parts});
  const Eigen::RowVector3d middle = mesh.points.colwise().mean();
  Eigen::Index row = 0;
  for (const auto& joint : joints) {
    for (const auto node : joint.node) {
      const Eigen::RowVector3d x = (mesh.points.row(node) - middle) / extent;
      Eigen::Matrix<double, 3, 6> motion;
      motion << 1, 0, 0, 0, x(2), -x(1), 0, 1, 0, -x(2), 0, x(0), 0, 0, 1, x(1), -x(0), 0;
      apart.block<3, 6>(row, 6 * Eigen::Index{joint.first}) = motion;
      apart.block<3, 6>(row, 6 * Eigen::Index{joint.second}) = -motion;
      row += 3;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(apart.transpose() * apart), Eigen::EigenvaluesOnly);
  const double none = 1e-14 * solver.eigenvalues().maxCoeff();
  return static_cast<int>((solver.eigenvalues().array() < none).count()) - 6;
}

}  // namespace

Parts parts_by_faces(const TetMesh& mesh) {
  std::vector<Key> keys;
  keys.reserve(at(4 * mesh.tet_count()));
  for (const auto tet : mesh.tets.rowwise()) {
    for (const auto& face : kTetFaces) {
      keys.push_back(face_key(tet(face[0]), tet(face[1]), tet(face[2])));
    }
  }
  const auto faces = shared_numbers(keys, static_cast<std::int32_t>(mesh.node_count()));
  DisjointSets sets(at(mesh.tet_count()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    sets.join(i / 4, at(faces.first[at(faces.number[i])]) / 4);
  }
  Parts parts{sets.numbers(), 0};
  if (!parts.of_cell.empty()) {
    parts.count = *std::max_element(parts.of_cell.begin(), parts.of_cell.end()) + 1;
  }
  return parts;
}

Mechanism mechanism(const TetMesh& mesh) {
  constexpr int kMostParts = 60;
  Mechanism found{.parts = parts_by_faces(mesh)};
  if (found.parts.count < 2) return found;
  const double extent =
      (mesh.points.colwise().maxCoeff() - mesh.points.colwise().minCoeff()).maxCoeff();
  found.parts = joined(mesh, std::move(found.parts), extent);
  if (found.parts.count < 2) return found;
  for (auto& [pair, nodes] : shared_nodes(mesh, found.parts)) {
    found.joints.push_back({pair.first, pair.second, std::move(nodes)});
  }
  found.free_motions = found.parts.count > kMostParts
                           ? 1
                           : free_motions(mesh, found.joints, found.parts.count, extent);
  return found;
}

}  // namespace chladni::mesh
