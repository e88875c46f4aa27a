// Checks whether a tetrahedral mesh can be used for elements.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/text_stream.h"
#include "mesh/disjoint_sets.h"
#include "mesh/tet_mesh.h"
#include "mesh/tets/joints.h"

namespace chladni::mesh {
namespace {

constexpr std::size_t kListed = 10;  // offenders named in a message

// Counts offenders and keeps the words for the first ten.
class Offenders {
 public:
  void add(const std::string& words) {
    if (++count_ <= kListed) text_ += "\n  " + words;
  }
  void throw_if_any(const std::string& what, const std::string& remedy) const {
    if (count_ == 0) return;
    const std::string more =
        count_ > kListed ? "\n  ... and " + fmt::to_string(count_ - kListed) + " more" : "";
    throw InvalidInput("mesh: " + fmt::to_string(count_) + " " + what + ":" + text_ + more +
                       (remedy.empty() ? "" : "\n  " + remedy));
  }

 private:
  std::size_t count_ = 0;
  std::string text_;
};

std::string place(const Eigen::RowVector3d& p) {
  TextWriter text;
  text.precision(4);
  text << "(" << 1e3 * p(0) << ", " << 1e3 * p(1) << ", " << 1e3 * p(2) << ") mm";
  return text.str();
}

void check_labels(const Eigen::VectorXi& label, Eigen::Index cells, std::size_t names,
                  const std::string& what) {
  require(label.size() == cells, "mesh: " + fmt::to_string(label.size()) + " " + what +
                                     " numbers for " + fmt::to_string(cells) + " cells");
  for (Eigen::Index i = 0; i < cells; ++i) {
    require(0 <= label(i) && label(i) < static_cast<int>(names),
            "mesh: cell " + fmt::to_string(i) + " has " + what + " " + fmt::to_string(label(i)) +
                ", there are " + fmt::to_string(names));
  }
}

void check_arrays(const TetMesh& mesh) {
  require(mesh.tets.rows() > 0, "mesh: no tetrahedra, expected at least one");
  const Eigen::Index nodes = mesh.tets.cols();
  require(nodes == 4 || nodes == 10 || nodes == 20,
          "mesh: tetrahedra of " + fmt::to_string(nodes) + " nodes, expected 4, 10 or 20");
  const auto per_face = static_cast<Eigen::Index>(face_nodes(mesh.order()));
  require(mesh.faces.rows() == 0 || mesh.faces.cols() == per_face,
          "mesh: boundary faces of " + fmt::to_string(mesh.faces.cols()) + " nodes, expected " +
              fmt::to_string(per_face));
  check_labels(mesh.region, mesh.tets.rows(), mesh.region_names.size(), "region");
  check_labels(mesh.face_patch, mesh.faces.rows(), mesh.patch_names.size(), "patch");
}

void check_indices(const Cells& cells, Eigen::Index points, const std::string& what) {
  Offenders outside;
  for (Eigen::Index c = 0; c < cells.rows(); ++c) {
    for (Eigen::Index a = 0; a < cells.cols(); ++a) {
      if (cells(c, a) >= 0 && cells(c, a) < points) continue;
      outside.add(what + " " + fmt::to_string(c) + " names point " + fmt::to_string(cells(c, a)));
      break;
    }
  }
  outside.throw_if_any("cells name points that are not there (there are " + fmt::to_string(points) +
                           ", counted from 0)",
                       "");
}

void check_points(const TetMesh& mesh) {
  Offenders not_finite;
  for (Eigen::Index p = 0; p < mesh.points.rows(); ++p) {
    if (mesh.points.row(p).allFinite()) continue;
    not_finite.add("point " + fmt::to_string(p));
  }
  not_finite.throw_if_any("points have coordinates that are not finite", "");

  std::vector<bool> used(static_cast<std::size_t>(mesh.points.rows()), false);
  for (Eigen::Index i = 0; i < mesh.tets.size(); ++i) {
    used[static_cast<std::size_t>(mesh.tets.data()[i])] = true;
  }
  Offenders unused;
  for (Eigen::Index p = 0; p < mesh.points.rows(); ++p) {
    if (used[static_cast<std::size_t>(p)]) continue;
    unused.add("point " + fmt::to_string(p) + " at " + place(mesh.points.row(p)));
  }
  unused.throw_if_any("points are used by no tetrahedron", "remove them");
}

// For each node of a tetrahedron of `order`, the derivatives of all shape functions by
// (λ1, λ2, λ3), nodes x 3. Shape functions = monomials · V⁻¹ with V(a, m) = m(node a).
std::vector<Eigen::MatrixXd> node_gradients(int order) {
  const Eigen::MatrixXd at = tet_node_barycentric(order).rightCols(3);
  const Eigen::Index n = at.rows();
  Eigen::MatrixXd values(n, n);
  std::vector<Eigen::MatrixXd> slopes(3, Eigen::MatrixXd(n, n));
  const auto power = [](double x, int k) { return k <= 0 ? 1.0 : std::pow(x, k); };
  Eigen::Index m = 0;
  for (int i = 0; i <= order; ++i) {
    for (int j = 0; i + j <= order; ++j) {
      for (int k = 0; i + j + k <= order; ++k, ++m) {
        for (Eigen::Index a = 0; a < n; ++a) {
          const double x = power(at(a, 0), i), y = power(at(a, 1), j), z = power(at(a, 2), k);
          values(a, m) = x * y * z;
          slopes[0](a, m) = i * power(at(a, 0), i - 1) * y * z;
          slopes[1](a, m) = j * x * power(at(a, 1), j - 1) * z;
          slopes[2](a, m) = k * x * y * power(at(a, 2), k - 1);
        }
      }
    }
  }
  const Eigen::MatrixXd inverse = values.inverse();
  std::vector<Eigen::MatrixXd> result(static_cast<std::size_t>(n), Eigen::MatrixXd(n, 3));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd by_axis = slopes[static_cast<std::size_t>(axis)] * inverse;
    for (Eigen::Index a = 0; a < n; ++a) {
      result[static_cast<std::size_t>(a)].col(axis) = by_axis.row(a).transpose();
    }
  }
  return result;
}

// The smallest volume by the local Jacobian (determinant / 6) over the nodes of one tetrahedron.
// Where the sides are straight, it is the volume itself.
double smallest_local_volume(const Eigen::Matrix<double, Eigen::Dynamic, 3>& nodes,
                             const Eigen::MatrixXd& barycentric,
                             const std::vector<Eigen::MatrixXd>& gradients, double longest) {
  const Eigen::Matrix<double, Eigen::Dynamic, 3> straight = barycentric * nodes.topRows(4);
  const Eigen::Matrix3d jacobian =
      nodes.middleRows<3>(1).rowwise() - nodes.row(0);  // rows: edges from corner 0
  double smallest = jacobian.determinant() / 6.0;
  if ((nodes - straight).cwiseAbs().maxCoeff() < 1e-9 * longest) return smallest;
  for (const auto& gradient : gradients) {
    const Eigen::Matrix3d local = gradient.transpose() * nodes;
    smallest = std::min(smallest, local.determinant() / 6.0);
  }
  return smallest;
}

// Refuses inverted and flat cells. A volume that may be round-off alone counts as flat.
void check_volumes(const TetMesh& mesh) {
  const Eigen::MatrixXd barycentric = tet_node_barycentric(mesh.order());
  const auto gradients = node_gradients(mesh.order());
  Eigen::Matrix<double, Eigen::Dynamic, 3> nodes(mesh.tets.cols(), 3);
  Offenders bad;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (Eigen::Index a = 0; a < nodes.rows(); ++a) nodes.row(a) = mesh.points.row(mesh.tets(t, a));
    double longest = 0.0;
    for (const auto& [a, b] : kTetEdges) {
      longest = std::max(longest, (nodes.row(a) - nodes.row(b)).norm());
    }
    const double volume = smallest_local_volume(nodes, barycentric, gradients, longest);
    const double noise = 1e-15 * nodes.cwiseAbs().maxCoeff() * longest * longest;
    if (volume > noise) continue;
    TextWriter words;
    words << "tetrahedron " << t << " at " << place(nodes.topRows(4).colwise().mean()) << ": "
          << (volume < -noise ? "inverted" : "flat") << ", volume " << volume << " m^3";
    bad.add(words.str());
  }
  bad.throw_if_any("tetrahedra are inverted or flat",
                   "mesh again, or check the node order of the file");
}

// Volume and centre of each part of the cells, in words.
std::vector<std::string> descriptions(const TetMesh& mesh, const std::vector<std::int32_t>& part_of,
                                      int parts) {
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(parts);
  Points centres = Points::Zero(parts, 3);
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    const auto part = static_cast<Eigen::Index>(part_of[static_cast<std::size_t>(t)]);
    Eigen::Matrix<double, 4, 3> corner;
    for (int a = 0; a < 4; ++a) corner.row(a) = mesh.points.row(mesh.tets(t, a));
    const Eigen::Matrix3d edges = corner.bottomRows<3>().rowwise() - corner.row(0);
    const double v = edges.determinant() / 6.0;
    volumes(part) += v;
    centres.row(part) += v * corner.colwise().mean();
  }
  std::vector<std::string> words;
  for (Eigen::Index b = 0; b < parts; ++b) {
    TextWriter text;
    text << "volume " << volumes(b) << " m^3, centre " << place(centres.row(b) / volumes(b));
    words.push_back(text.str());
  }
  return words;
}

void check_one_body(const TetMesh& mesh) {
  DisjointSets sets(static_cast<std::size_t>(mesh.points.rows()));
  for (const auto tet : mesh.tets.rowwise()) {
    for (Eigen::Index a = 1; a < tet.cols(); ++a) {
      sets.join(static_cast<std::size_t>(tet(0)), static_cast<std::size_t>(tet(a)));
    }
  }
  const std::vector<std::int32_t> body_of = sets.numbers();
  const int bodies = *std::max_element(body_of.begin(), body_of.end()) + 1;
  if (bodies == 1) return;
  std::vector<std::int32_t> of_cell;
  for (const auto tet : mesh.tets.rowwise()) {
    of_cell.push_back(body_of[static_cast<std::size_t>(tet(0))]);
  }
  Offenders several;
  for (const auto& words : descriptions(mesh, of_cell, bodies)) several.add(words);
  several.throw_if_any("bodies share no node", "join them, or give each a study of its own");
}

// The place where two parts meet, in words: a node, or a line of nodes given by its ends.
std::string place_of(const TetMesh& mesh, const Joint& joint) {
  const auto& nodes = joint.node;
  if (nodes.size() == 1) return "at the node at " + place(mesh.points.row(nodes.front()));
  const auto further = [&](const Eigen::RowVector3d& from) {
    return *std::max_element(nodes.begin(), nodes.end(), [&](std::int32_t a, std::int32_t b) {
      return (mesh.points.row(a) - from).norm() < (mesh.points.row(b) - from).norm();
    });
  };
  const auto end = further(mesh.points.row(nodes.front()));
  const auto begin = further(mesh.points.row(end));
  return "along the edge from " + place(mesh.points.row(begin)) + " to " +
         place(mesh.points.row(end));
}

void check_mechanism(const TetMesh& mesh) {
  const auto found = mechanism(mesh);
  if (found.free_motions == 0) return;
  const auto words = descriptions(mesh, found.parts.of_cell, found.parts.count);
  Offenders joints;
  for (const auto& joint : found.joints) {
    joints.add(place_of(mesh, joint) + " (" + words[static_cast<std::size_t>(joint.first)] +
               "; and " + words[static_cast<std::size_t>(joint.second)] + ")");
  }
  joints.throw_if_any(
      "places where parts of the body meet in an edge or a node only, about which "
      "they turn at no cost",
      "join the parts by common faces, or leave one of them out");
}

}  // namespace

void check(const TetMesh& mesh) {
  check_arrays(mesh);
  check_indices(mesh.tets, mesh.points.rows(), "tetrahedron");
  check_indices(mesh.faces, mesh.points.rows(), "boundary face");
  check_points(mesh);
  check_volumes(mesh);
  check_one_body(mesh);
  check_mechanism(mesh);
}

}  // namespace chladni::mesh
