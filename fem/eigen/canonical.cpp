#include "fem/eigen/canonical.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "modal/repeated.h"

namespace chladni::fem {
namespace {

// The functionals that choose a basis, in the order in which they are tried: powers of x, y, z and
// the axis of motion that counts (3: all axes).
struct Functional {
  int x, y, z, axis;
};
constexpr std::array<Functional, 14> kFunctionals{{{2, 0, 0, 3},
                                                   {0, 2, 0, 3},
                                                   {1, 1, 0, 3},
                                                   {1, 0, 1, 3},
                                                   {0, 1, 1, 3},
                                                   {0, 0, 0, 0},
                                                   {0, 0, 0, 1},
                                                   {4, 0, 0, 3},
                                                   {2, 2, 0, 3},
                                                   {2, 0, 2, 3},
                                                   {3, 1, 0, 3},
                                                   {2, 0, 0, 0},
                                                   {0, 2, 0, 1},
                                                   {1, 0, 0, 3}}};

// Per degree of freedom, the functional's weight times the diagonal entry of M. The body is scaled
// to size 1.
Eigen::VectorXd weights(const System& system, const Functional& f) {
  const auto n = system.mass.rows();
  Eigen::VectorXd w = system.mass.diagonal();
  if (system.positions.rows() != n) {  // a system without positions: use the numbering instead
    const auto power = 1 + f.x + 2 * f.y + 3 * f.z + f.axis;
    for (Eigen::Index i = 0; i < n; ++i) w(i) *= std::pow(double(i + 1) / double(n), power);
    return w;
  }
  const Eigen::RowVector3d low = system.positions.colwise().minCoeff();
  const Eigen::RowVector3d high = system.positions.colwise().maxCoeff();
  const double size = std::max((high - low).maxCoeff(), 1e-300);
  const auto power = [](double x, int k) {
    double result = 1.0;
    for (; k > 0; --k) result *= x;
    return result;
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVector3d p = (system.positions.row(i) - 0.5 * (low + high)) / size;
    w(i) *= power(p(0), f.x) * power(p(1), f.y) * power(p(2), f.z);
  }
  if (f.axis < 3) {
    for (Eigen::Index dof = 0; dof < system.dofs.free_dof.size(); ++dof) {
      const int row = system.dofs.free_dof(dof);
      if (row >= 0 && (dof >= 3 * system.dofs.node_count || dof % 3 != f.axis)) w(row) = 0.0;
    }
  }
  return w;
}

// Diagonalises functional `next`. Shapes that stay equal go on to the functional after it.
void refine(const System& system, Eigen::Ref<Eigen::MatrixXd> shapes, std::size_t next) {
  if (shapes.cols() < 2 || next == kFunctionals.size()) return;
  const Eigen::VectorXd w = weights(system, kFunctionals[next]);
  const Eigen::MatrixXd a = shapes.transpose() * w.asDiagonal() * shapes;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(0.5 * (a + a.transpose())));
  const Eigen::VectorXd d = solver.eigenvalues().reverse();
  constexpr double tolerance = 1e-5;  // the values lie within ±1/4; far above rounding
  if (d(0) - d(d.size() - 1) < tolerance) return refine(system, shapes, next + 1);
  shapes = (shapes * solver.eigenvectors().rowwise().reverse()).eval();
  for (Eigen::Index first = 0; first < d.size();) {
    Eigen::Index size = 1;
    while (first + size < d.size() && d(first + size - 1) - d(first + size) < tolerance) ++size;
    refine(system, shapes.middleCols(first, size), next + 1);
    first += size;
  }
}

void fix_sign(Eigen::Ref<Eigen::VectorXd> shape) {
  const double largest = shape.cwiseAbs().maxCoeff();
  Eigen::Index i = 0;
  while (std::abs(shape(i)) < (1.0 - 1e-6) * largest) ++i;
  if (shape(i) < 0.0) shape = -shape;
}

// Runs of neighbours closer than `tolerance` (relative), from column `first` on.
std::vector<Cluster> runs(const Eigen::VectorXd& lambda, Eigen::Index first, double tolerance) {
  std::vector<Cluster> result;
  for (Eigen::Index i = first; i < lambda.size();) {
    Eigen::Index size = 1;
    while (i + size < lambda.size() &&
           lambda(i + size) - lambda(i + size - 1) < tolerance * lambda(i + size)) {
      ++size;
    }
    if (size > 1) result.push_back({i, size});
    i += size;
  }
  return result;
}

}  // namespace

std::vector<Cluster> orient(const System& system, Eigen::VectorXd& lambda, Eigen::MatrixXd& shapes,
                            Eigen::Index rigid) {
  auto repeated = runs(lambda, rigid, modal::kEqualToTheSolver);
  for (const auto& cluster : repeated) {
    refine(system, shapes.middleCols(cluster.first, cluster.size), 0);
    lambda.segment(cluster.first, cluster.size)
        .setConstant(lambda.segment(cluster.first, cluster.size).mean());
  }
  for (Eigen::Index i = rigid; i < shapes.cols(); ++i) fix_sign(shapes.col(i));
  return repeated;
}

std::vector<Cluster> clusters(const Eigen::VectorXd& lambda, Eigen::Index rigid) {
  return runs(lambda, rigid, 2.0 * modal::kSplitByMesh);
}

}  // namespace chladni::fem
