#include "fem/factor_check.h"

#include <cmath>
#include <numbers>

#include "fem/eigen/symmetric_product.h"
#include "fem/factor/cholmod.h"
#include "fem/factor/factorization.h"

namespace chladni::fem {

FactorCheck factor_check(const System& system, double hz) {
  const double s = std::pow(2.0 * std::numbers::pi * hz, 2);
  const Symbolic symbolic(system.stiffness, system.mass);
  const auto ours = inertia(symbolic, system.stiffness, -s, system.mass);
  const auto theirs = second_inertia(SparseMatrix(system.stiffness - s * system.mass));

  const SparseMatrix a = system.stiffness + s * system.mass;
  const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(
      a.rows(), 4, [](auto i, auto j) { return std::sin(1.0 + 0.37 * double(i) + double(j)); });
  const Factorization factor(symbolic, system.stiffness, s, system.mass);
  const Eigen::MatrixXd x = factor.solve(b);
  const double off = (SymmetricProduct(a) * x - b).norm();
  return {.counted = ours.negative,
          .counted_by_cholmod = theirs.negative,
          .trusted = ours.trusted(),
          .residual = off / (a.norm() * x.norm() + b.norm())};
}

}  // namespace chladni::fem
