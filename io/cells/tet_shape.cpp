#include "io/cells/tet_shape.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "mesh/tet_mesh.h"

namespace chladni::io {
namespace {

using Barycentric = Eigen::Vector4d;

// The Lagrange polynomial of one coordinate, prod over j < n of (order·l − j) / (n − j), and its
// derivative. The shape function of a node is the product of these polynomials over the four
// coordinates (Silvester 1969).
struct Factor {
  double value = 1.0, derivative = 0.0;
};
Factor factor(int order, int n, double l) {
  Factor f;
  for (int j = 0; j < n; ++j) {
    const double linear = (order * l - j) / (n - j);
    f.derivative = f.derivative * linear + f.value * order / (n - j);
    f.value *= linear;
  }
  return f;
}

// Derivatives of all shape functions along the four barycentric coordinates at `l`, nodes×4.
Eigen::MatrixX4d derivatives(int order, const Eigen::MatrixXd& places, const Barycentric& l) {
  Eigen::MatrixX4d result(places.rows(), 4);
  for (Eigen::Index node = 0; node < result.rows(); ++node) {
    const Eigen::Vector4d n = places.row(node) * order;
    std::array<Factor, 4> f;
    for (int i = 0; i < 4; ++i) {
      f.at(static_cast<std::size_t>(i)) = factor(order, static_cast<int>(n[i] + 0.5), l[i]);
    }
    for (int i = 0; i < 4; ++i) {
      double product = f.at(static_cast<std::size_t>(i)).derivative;
      for (int j = 0; j < 4; ++j) {
        if (j != i) product *= f.at(static_cast<std::size_t>(j)).value;
      }
      result(node, i) = product;
    }
  }
  return result;
}

int order_of(const Points& nodes) { return nodes.rows() == 10 ? 2 : 3; }

std::vector<Eigen::MatrixX4d> derivatives_at_samples(int order) {
  constexpr double kA = 0.5854101966249685, kB = 0.1381966011250105;  // (5 + 3√5)/20, (5 − √5)/20
  const auto places = mesh::tet_node_barycentric(order);
  std::vector<Eigen::MatrixX4d> samples{derivatives(order, places, Barycentric::Constant(0.25))};
  for (int corner = 0; corner < 4; ++corner) {
    Barycentric l = Barycentric::Constant(kB);
    l[corner] = kA;
    samples.push_back(derivatives(order, places, l));
  }
  return samples;
}

}  // namespace

void turn_inside_out(
    Eigen::Ref<Eigen::Matrix<std::int32_t, 1, Eigen::Dynamic, Eigen::RowMajor>> cell) {
  std::swap(cell[0], cell[1]);
  if (cell.size() == 10) {
    std::swap(cell[5], cell[6]);  // edges 12 and 20
    std::swap(cell[7], cell[8]);  // edges 03 and 13
  } else if (cell.size() == 20) {
    std::swap(cell[4], cell[5]);    // edge 01, backwards
    std::swap(cell[6], cell[9]);    // edges 12 and 20, backwards
    std::swap(cell[7], cell[8]);    //
    std::swap(cell[10], cell[12]);  // edges 03 and 13
    std::swap(cell[11], cell[13]);  //
    std::swap(cell[17], cell[18]);  // faces 123 and 023
  }
}

double largest_offset(const Points& nodes) {
  static const std::array<Eigen::MatrixXd, 2> kPlaces{mesh::tet_node_barycentric(2),
                                                      mesh::tet_node_barycentric(3)};
  const auto& places = kPlaces.at(static_cast<std::size_t>(order_of(nodes) - 2));
  double longest = 0.0, largest = 0.0;
  for (const auto& [a, b] : mesh::kTetEdges) {
    longest = std::max(longest, (nodes.row(a) - nodes.row(b)).norm());
  }
  for (Eigen::Index n = 4; n < nodes.rows(); ++n) {
    const Eigen::RowVector3d straight = places.row(n) * nodes.topRows<4>();
    largest = std::max(largest, (nodes.row(n) - straight).norm());
  }
  return largest / longest;
}

double smallest_jacobian(const Points& nodes) {
  static const std::array<std::vector<Eigen::MatrixX4d>, 2> kSamples{derivatives_at_samples(2),
                                                                     derivatives_at_samples(3)};
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (const auto& dn : kSamples.at(static_cast<std::size_t>(order_of(nodes) - 2))) {
    const Eigen::Matrix<double, 4, 3> dx = dn.transpose() * nodes;
    const Eigen::Matrix3d jacobian = dx.bottomRows<3>().rowwise() - dx.row(0);
    const double determinant = jacobian.determinant();
    smallest = std::min(smallest, determinant);
    largest = std::max(largest, determinant);
  }
  return largest > 0.0 ? smallest / largest : smallest;
}

}  // namespace chladni::io
