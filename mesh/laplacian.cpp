#include "mesh/laplacian.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "mesh/disjoint_sets.h"
#include "mesh/faces.h"

namespace chladni::mesh {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

// The points that the cells use, numbered in the order of the mesh's nodes.
struct Numbering {
  std::vector<int> row;            // per node; −1: none
  std::vector<Eigen::Index> node;  // per row
};

Numbering numbering(Eigen::Index node_count, const std::vector<int>& used) {
  Numbering numbers{std::vector<int>(static_cast<std::size_t>(node_count), -1), {}};
  for (const int node : used) numbers.row[static_cast<std::size_t>(node)] = 0;
  for (std::size_t node = 0; node < numbers.row.size(); ++node) {
    if (numbers.row[node] < 0) continue;
    numbers.row[node] = static_cast<int>(numbers.node.size());
    numbers.node.push_back(static_cast<Eigen::Index>(node));
  }
  return numbers;
}

// Sums over cells of d + 1 corners. The gradients are constant on each cell.
class Assembly {
 public:
  Assembly(const Points& points, const std::vector<int>& cells, Eigen::Index corners)
      : corners_(corners), numbers_(numbering(points.rows(), cells)), sets_(numbers_.node.size()) {
    operators_.positions = points(numbers_.node, Eigen::all);
  }

  // @param gradients  (d+1)×3, of the corner functions; @param measure  area or volume
  void add(const int* cell, const Eigen::MatrixX3d& gradients, double measure) {
    const Eigen::MatrixXd stiffness = measure * gradients * gradients.transpose();
    const auto d = static_cast<double>(corners_ - 1);
    const double share = measure / ((d + 1.0) * (d + 2.0));
    for (Eigen::Index a = 0; a < corners_; ++a) {
      const int i = numbers_.row[static_cast<std::size_t>(cell[a])];
      sets_.join(static_cast<std::size_t>(i),
                 static_cast<std::size_t>(numbers_.row[static_cast<std::size_t>(cell[0])]));
      for (Eigen::Index b = 0; b < corners_; ++b) {
        const int j = numbers_.row[static_cast<std::size_t>(cell[b])];
        if (i < j) continue;
        stiffness_.emplace_back(i, j, stiffness(a, b));
        mass_.emplace_back(i, j, a == b ? 2.0 * share : share);
      }
    }
  }

  Laplacian finished() {
    const auto k = operators_.positions.rows();
    operators_.stiffness.resize(k, k);
    operators_.stiffness.setFromTriplets(stiffness_.begin(), stiffness_.end());
    operators_.mass.resize(k, k);
    operators_.mass.setFromTriplets(mass_.begin(), mass_.end());
    const auto pieces = sets_.numbers();
    operators_.piece = Eigen::Map<const Eigen::VectorXi>(pieces.data(), k);
    return std::move(operators_);
  }

  [[nodiscard]] const Numbering& numbers() const { return numbers_; }

 private:
  Eigen::Index corners_;
  Numbering numbers_;
  DisjointSets sets_;
  Laplacian operators_;
  Triplets stiffness_, mass_;
};

// Three node numbers for each small triangle of the wanted faces.
std::vector<int> small_triangles(const TetMesh& mesh, const std::vector<std::string>& patches) {
  const auto wanted = chosen_patches(mesh, patches, "surface");
  const auto pieces = face_triangles(mesh.order());
  std::vector<int> triangles;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    if (wanted[static_cast<std::size_t>(mesh.face_patch(f))] == 0) continue;
    for (const auto& piece : pieces) {
      for (const int node : piece) triangles.push_back(mesh.faces(f, node));
    }
  }
  require(!triangles.empty(), "surface: the patches have no faces");
  return triangles;
}

std::string place_text(const Eigen::RowVector3d& at) {
  return "(" + fmt::to_string(at(0)) + ", " + fmt::to_string(at(1)) + ", " + fmt::to_string(at(2)) +
         ") m";
}

// The edge opposite each corner. This edge, turned by 90 degrees and divided by twice the area, is
// the gradient of the corner's function. The operator needs only products of gradients, and these
// do not change when all edges are turned.
Eigen::MatrixX3d edges_of_triangle(const Eigen::Matrix3d& corners) {
  Eigen::MatrixX3d edges(3, 3);
  for (Eigen::Index a = 0; a < 3; ++a) {
    edges.row(a) = corners.row((a + 2) % 3) - corners.row((a + 1) % 3);
  }
  return edges;
}

// The matrix that interpolates corner values to all nodes of the tetrahedra.
SparseMatrix onto_nodes(const TetMesh& mesh, const Numbering& numbers) {
  const Eigen::MatrixXd weights = tet_node_barycentric(mesh.order());
  std::vector<char> done(static_cast<std::size_t>(mesh.node_count()), 0);
  Triplets entries;
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    for (Eigen::Index a = 0; a < mesh.tets.cols(); ++a) {
      auto& known = done[static_cast<std::size_t>(mesh.tets(t, a))];
      if (known != 0) continue;
      known = 1;
      for (Eigen::Index corner = 0; corner < 4; ++corner) {
        if (weights(a, corner) == 0.0) continue;
        entries.emplace_back(mesh.tets(t, a),
                             numbers.row[static_cast<std::size_t>(mesh.tets(t, corner))],
                             weights(a, corner));
      }
    }
  }
  SparseMatrix onto(mesh.node_count(), static_cast<Eigen::Index>(numbers.node.size()));
  onto.setFromTriplets(entries.begin(), entries.end());
  return onto;
}

}  // namespace

Laplacian surface_laplacian(const TetMesh& mesh, const std::vector<std::string>& patches) {
  const auto triangles = small_triangles(mesh, patches);
  Assembly assembly(mesh.points, triangles, 3);
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const Eigen::Matrix3d corners =
        mesh.points(std::vector<int>(triangles.begin() + static_cast<std::ptrdiff_t>(t),
                                     triangles.begin() + static_cast<std::ptrdiff_t>(t) + 3),
                    Eigen::all);
    const Eigen::MatrixX3d edges = edges_of_triangle(corners);
    const Eigen::RowVector3d first = edges.row(0);
    const double twice = first.cross(Eigen::RowVector3d(edges.row(1))).norm();
    require(twice > 1e-14 * edges.squaredNorm(),
            "surface: the face at " + place_text(corners.row(0)) + " has no area");
    assembly.add(&triangles[t], edges / twice, 0.5 * twice);
  }
  auto operators = assembly.finished();
  Triplets ones;
  const auto& node = assembly.numbers().node;
  for (std::size_t i = 0; i < node.size(); ++i) {
    ones.emplace_back(static_cast<int>(node[i]), static_cast<int>(i), 1.0);
  }
  operators.on_nodes.resize(mesh.node_count(), operators.positions.rows());
  operators.on_nodes.setFromTriplets(ones.begin(), ones.end());
  return operators;
}

Laplacian body_laplacian(const TetMesh& mesh) {
  std::vector<int> corners;
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    for (Eigen::Index a = 0; a < 4; ++a) corners.push_back(mesh.tets(t, a));
  }
  require(!corners.empty(), "body: the mesh has no tetrahedra");
  Assembly assembly(mesh.points, corners, 4);
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) {
    const int* cell = &corners[static_cast<std::size_t>(4 * t)];
    Eigen::Matrix4d basis;  // rows: 1 x y z of each corner
    for (Eigen::Index a = 0; a < 4; ++a) basis.row(a) << 1.0, mesh.points.row(cell[a]);
    const double volume = basis.determinant() / 6.0;
    require(volume > 0.0,
            "body: the tetrahedron at " + place_text(mesh.points.row(cell[0])) + " has no volume");
    const Eigen::Matrix4d inverse = basis.inverse();
    assembly.add(cell, inverse.bottomRows<3>().transpose(), volume);
  }
  auto operators = assembly.finished();
  operators.on_nodes = onto_nodes(mesh, assembly.numbers());
  return operators;
}

}  // namespace chladni::mesh
