#include "fem/eigen/residual.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/interrupt.h"
#include "fem/eigen/symmetric_product.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

// The product A x, summed with 64 bits of mantissa. A is stored as its lower triangle.
Eigen::VectorXd long_product(const SparseMatrix& a, const Eigen::Ref<const Eigen::VectorXd>& x) {
  Eigen::Matrix<long double, Eigen::Dynamic, 1> y =
      Eigen::Matrix<long double, Eigen::Dynamic, 1>::Zero(a.rows());
  for (Eigen::Index column = 0; column < a.cols(); ++column) {
    if (column % 65536 == 0) throw_if_interrupted();
    const long double at_column = x(column);
    long double sum = 0.0L;
    for (SparseMatrix::InnerIterator entry(a, column); entry; ++entry) {
      const long double value = entry.value();
      if (entry.row() == column) {
        sum += value * at_column;
      } else {
        y(entry.row()) += value * at_column;
        sum += value * static_cast<long double>(x(entry.row()));
      }
    }
    y(column) += sum;
  }
  return y.cast<double>();
}

Matrix long_products(const SparseMatrix& a, const Matrix& x) {
  Matrix product(x.rows(), x.cols());
  parallel_ranges(static_cast<std::size_t>(x.cols()), [&](std::size_t begin, std::size_t end) {
    for (auto j = static_cast<Eigen::Index>(begin); j < static_cast<Eigen::Index>(end); ++j) {
      product.col(j) = long_product(a, x.col(j));
    }
  });
  return product;
}

// (K + sM)⁻¹(KΦ − MΦΛ) and its norms relative to λ. Its part along the known modes is only rounding
// and is removed. The columns are computed a few at a time.
struct Correction {
  Matrix shapes;
  Eigen::VectorXd residual;
};

Correction correction(const System& system, const Factorization& factor, double s,
                      const Matrix& known, const Eigen::VectorXd& lambda, const Matrix& shapes,
                      const Matrix& stiffness_product) {
  SymmetricProduct mass(system.mass);
  const Matrix known_inertia = mass * known;
  Correction result{Matrix(shapes.rows(), shapes.cols()), Eigen::VectorXd(lambda.size())};
  constexpr Eigen::Index at_once = 8;
  for (Eigen::Index first = 0; first < lambda.size(); first += at_once) {
    throw_if_interrupted();
    const auto count = std::min(at_once, lambda.size() - first);
    const auto values = lambda.segment(first, count);
    const Matrix inertia = mass * shapes.middleCols(first, count);
    Matrix r = stiffness_product.middleCols(first, count) - inertia * values.asDiagonal();
    r -= known_inertia * (known.transpose() * r);
    auto x = result.shapes.middleCols(first, count);
    x = factor.solve(r);
    x -= known * (known_inertia.transpose() * x);
    const Matrix mx = mass * x;
    for (Eigen::Index i = 0; i < count; ++i) {
      const double norm = std::sqrt(std::max(0.0, x.col(i).dot(mx.col(i))));
      result.residual(first + i) = std::abs(norm * (values(i) + s) / values(i));
    }
  }
  return result;
}

struct Eigenpairs {
  Eigen::VectorXd values;  // ascending
  Matrix vectors;
};

// Eigenpairs of a positive definite matrix, each value accurate to its own last digits, by Jacobi
// rotations (Demmel and Veselić 1992, SIAM J. Matrix Anal. Appl. 13, 1204-1245). Reduction to a
// tridiagonal matrix has an error of 10⁻¹⁶ of the largest eigenvalue, which here is 10¹⁰ times the
// smallest.
Eigenpairs graded_eigenpairs(const Matrix& matrix) {
  constexpr double kDone = 1e-15;
  constexpr int kSweeps = 30;
  Matrix a = 0.5 * (matrix + matrix.transpose());
  Matrix v = Matrix::Identity(a.rows(), a.cols());
  for (int sweep = 0, turned = 1; sweep < kSweeps && turned > 0; ++sweep) {
    turned = 0;
    for (Eigen::Index p = 0; p < a.cols(); ++p) {
      for (Eigen::Index q = p + 1; q < a.cols(); ++q) {
        if (std::abs(a(p, q)) <= kDone * std::sqrt(std::abs(a(p, p) * a(q, q)))) continue;
        Eigen::JacobiRotation<double> rotation;
        rotation.makeJacobi(a, p, q);
        a.applyOnTheRight(p, q, rotation);
        a.applyOnTheLeft(p, q, rotation.adjoint());
        v.applyOnTheRight(p, q, rotation);
        ++turned;
      }
    }
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(a.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index i, Eigen::Index j) { return a(i, i) < a(j, j); });
  return {a.diagonal()(order), v(Eigen::all, order)};
}

}  // namespace

// Write Φ = R A + Ψ, where R are the suspended motions and F the forces of their springs. Then
// K Φ = F A + K Ψ, and the part of K Ψ along R is FᵀΨ.
Eigen::MatrixXd stiffness_times(const System& system, const Matrix& shapes) {
  if (system.suspended.cols() == 0) return long_products(system.stiffness, shapes);
  const auto& r = system.suspended;
  const Matrix mr = SymmetricProduct(system.mass) * r;
  Matrix whole = mr.transpose() * shapes;
  Matrix bent = shapes - r * whole;
  const Matrix more = mr.transpose() * bent;
  bent.noalias() -= r * more;
  whole += more;
  Matrix product = long_products(system.stiffness, bent);
  const Matrix along = system.suspension_force.transpose() * bent - r.transpose() * product;
  product.noalias() += mr * along;
  product.noalias() += system.suspension_force * whole;
  return product;
}

Eigen::VectorXd residuals(const System& system, const Factorization& factor, double s,
                          const Matrix& known, const Eigen::VectorXd& lambda,
                          const Matrix& shapes) {
  const Matrix product = SymmetricProduct(system.stiffness) * shapes;
  return correction(system, factor, s, known, lambda, shapes, product).residual;
}

Matrix ritz(const System& system, Eigen::VectorXd& lambda, Matrix& shapes, Matrix& product) {
  const Matrix energy = shapes.transpose() * product;
  const Matrix gram = shapes.transpose() * (SymmetricProduct(system.mass) * shapes);
  const Matrix to_orthonormal = Eigen::LLT<Matrix>(Matrix(0.5 * (gram + gram.transpose())))
                                    .matrixU()
                                    .solve(Matrix::Identity(gram.rows(), gram.cols()));
  const auto [values, vectors] =
      graded_eigenpairs(to_orthonormal.transpose() * energy * to_orthonormal);
  lambda = values;
  Matrix turn = to_orthonormal * vectors;
  shapes = (shapes * turn).eval();
  product = (product * turn).eval();
  return turn;
}

Eigen::VectorXd polished(const System& system, const Factorization& factor, double s,
                         const Matrix& known, Eigen::VectorXd& lambda, Matrix& shapes) {
  Matrix product = stiffness_times(system, shapes);
  {
    const Matrix step = correction(system, factor, s, known, lambda, shapes, product).shapes;
    shapes -= step;
    product -= SymmetricProduct(system.stiffness) * step;
  }
  ritz(system, lambda, shapes, product);
  return correction(system, factor, s, known, lambda, shapes, product).residual;
}

Eigen::VectorXd rigid_residuals(const System& system, const Matrix& shapes) {
  double norm = 0.0;  // the largest diagonal entry of K, a lower bound of ‖K‖₁
  for (Eigen::Index i = 0; i < system.stiffness.cols(); ++i) {
    norm = std::max(norm, system.stiffness.coeff(i, i));
  }
  const Matrix k = SymmetricProduct(system.stiffness) * shapes;
  return (k.colwise().norm().array() / (norm * shapes.colwise().norm().array())).transpose();
}

}  // namespace chladni::fem
