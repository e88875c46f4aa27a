#include "identification/likelihood/general_mode.h"

#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "identification/likelihood/complex_shapes.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

// l and r of l r / (s − p).
Eigen::VectorXcd left_of(const Block& block) {
  return block.left.col(0) + Complex(0.0, 1.0) * block.left.col(1);
}
Eigen::RowVectorXcd right_of(const Block& block) {
  return 0.5 * (block.right.row(0) - Complex(0.0, 1.0) * block.right.row(1));
}

// c of L = c l, R = c r.
Complex factor_of(const Block& block) { return std::sqrt(Complex(0.0, 2.0 * block.pole.imag())); }

// Jacobian. Rows (ω, ζ, Re L, Re R, Im L, Im R), columns (Re l, Im l, right by columns, σ, ω_d).
Eigen::MatrixXd complex_mode_jacobian(const Block& block, double scale) {
  const auto p = block.left.rows();
  const auto q = block.right.cols();
  const double own = std::abs(block.pole);
  const double sigma = block.pole.real();
  const double omega = block.pole.imag();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 + 2 * (p + q), 2 + 2 * (p + q));
  const auto at = 2 * (p + q);
  jacobian(0, at) = scale * sigma / own;
  jacobian(0, at + 1) = scale * omega / own;
  jacobian(1, at) = -1.0 / own + sigma * sigma / (own * own * own);
  jacobian(1, at + 1) = sigma * omega / (own * own * own);
  const auto put = [&](Eigen::Index row, Eigen::Index column, Complex slope) {
    jacobian(2 + row, column) = slope.real();
    jacobian(2 + p + q + row, column) = slope.imag();
  };
  const Complex c = scale * factor_of(block);
  const Complex by_omega = c / (2.0 * omega);
  const Eigen::VectorXcd l = left_of(block);
  const Eigen::RowVectorXcd r = right_of(block);
  for (Eigen::Index i = 0; i < p; ++i) {
    put(i, i, c);
    put(i, p + i, Complex(0.0, 1.0) * c);
    put(i, at + 1, by_omega * l(i));
  }
  for (Eigen::Index j = 0; j < q; ++j) {
    put(p + j, 2 * p + 2 * j, 0.5 * c);
    put(p + j, 2 * p + 2 * j + 1, Complex(0.0, -0.5) * c);
    put(p + j, at + 1, by_omega * r(j));
  }
  return jacobian;
}

// Projector that keeps |L| = |R| and the phase of Σ L² + conj(Σ R²): 1 − N (GᵀN)⁻¹ Gᵀ on (Re
// L, Re R, Im L, Im R). N are the changes by a complex factor between both sides, G the
// gradients of the two rules.
Eigen::MatrixXd held(const Eigen::VectorXcd& l, const Eigen::RowVectorXcd& r) {
  const auto p = l.size();
  const auto q = r.size();
  const auto column = [&](const Eigen::VectorXcd& left, const Eigen::RowVectorXcd& right) {
    Eigen::VectorXd all(2 * (p + q));
    all << left.real(), right.real().transpose(), left.imag(), right.imag().transpose();
    return all;
  };
  const Complex j(0.0, 1.0);
  Eigen::MatrixXd idle(2 * (p + q), 2);
  idle << column(l, -r), column(j * l, -j * r);
  if (idle.isZero(0.0)) return Eigen::MatrixXd::Identity(2 * (p + q), 2 * (p + q));
  Eigen::MatrixXd rule = idle;
  const Complex sum = (l.array() * l.array()).sum() + std::conj((r.array() * r.array()).sum());
  if (std::abs(sum) > 1e-6 * (l.squaredNorm() + r.squaredNorm())) {
    rule.col(1) = column(j * l.conjugate(), -j * r.conjugate());
  }
  const Eigen::Matrix2d meet = rule.transpose() * idle;
  return Eigen::MatrixXd::Identity(2 * (p + q), 2 * (p + q)) -
         idle * meet.inverse() * rule.transpose();
}

}  // namespace

Block turned(const Block& block) {
  const Complex factor = factor_of(block);
  const Eigen::VectorXcd l = factor * left_of(block);
  const Eigen::RowVectorXcd r = factor * right_of(block);
  Complex phase = common_phase(l, r);
  Eigen::Index largest = 0;
  (phase * l).real().cwiseAbs().maxCoeff(&largest);
  if ((phase * l(largest)).real() < 0.0) phase = -phase;
  return general_mode(block.pole, phase / factor * l, r / (phase * factor));
}

GeneralMode general_mode_of(const Block& block, double scale, const Eigen::MatrixXd& covariance) {
  const auto count = 2 * (block.left.rows() + block.right.cols());
  const Complex factor = scale * factor_of(block);
  GeneralMode result{scale * std::abs(block.pole),
                     -block.pole.real() / std::abs(block.pole),
                     factor * left_of(block),
                     factor * right_of(block),
                     {}};
  Eigen::MatrixXd change = complex_mode_jacobian(block, scale);
  change.bottomRows(count) = held(result.outputs, result.inputs) * change.bottomRows(count);
  result.covariance = change * covariance * change.transpose();
  return result;
}

}  // namespace chladni::identification
