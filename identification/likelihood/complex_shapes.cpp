#include "identification/likelihood/complex_shapes.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

Complex pole(const modal::ReducedModel& model, Eigen::Index m) {
  const double own = 2.0 * std::numbers::pi * model.frequency_hz(m);
  const double ratio = model.damping_ratio(m);
  return {-ratio * own, own * std::sqrt(std::max(1e-24, 1.0 - ratio * ratio))};
}

}  // namespace

double phase_collinearity(const Eigen::VectorXcd& shape) {
  const double size = shape.squaredNorm();
  return size > 0.0 ? std::norm((shape.array() * shape.array()).sum()) / (size * size) : 1.0;
}

std::complex<double> common_phase(const Eigen::VectorXcd& outputs,
                                  const Eigen::RowVectorXcd& inputs) {
  const Complex sum = (outputs.array() * outputs.array()).sum() +
                      std::conj((inputs.array() * inputs.array()).sum());
  if (std::abs(sum) <= 1e-9 * (outputs.squaredNorm() + inputs.squaredNorm())) return 1.0;
  return std::polar(1.0, -0.5 * std::arg(sum));
}

Eigen::MatrixXcd responses(const modal::ReducedModel& model, const ComplexShapes& shapes,
                           const Eigen::VectorXd& frequency_hz) {
  const auto p = shapes.outputs.rows();
  const auto q = shapes.inputs.cols();
  const auto lines = frequency_hz.size();
  const auto n = model.mode_count();
  Eigen::MatrixXcd along(lines, 2 * n + 1);
  Eigen::MatrixXcd across = Eigen::MatrixXcd::Zero(2 * n + 1, p * q);
  const Eigen::ArrayXcd s = Complex(0.0, 2.0 * std::numbers::pi) * frequency_hz.array();
  along.col(2 * n).setOnes();
  if (model.residual.size() > 0) {
    across.row(2 * n) = model.residual.reshaped().transpose().cast<Complex>();
  }
  for (Eigen::Index m = 0; m < n; ++m) {
    const Eigen::MatrixXcd product = shapes.outputs.col(m) * shapes.inputs.row(m);
    if (m < model.rigid_count) {
      along.col(2 * m) = s.square().inverse();
      along.col(2 * m + 1).setZero();
      across.row(2 * m) = product.reshaped().transpose();
      continue;
    }
    const Complex own = pole(model, m);
    const Complex factor(0.0, 2.0 * own.imag());
    along.col(2 * m) = (s - own).inverse();
    along.col(2 * m + 1) = (s - std::conj(own)).inverse();
    across.row(2 * m) = (product / factor).reshaped().transpose();
    across.row(2 * m + 1) = across.row(2 * m).conjugate();
  }
  return along * across;
}

modal::StateSpace state_space(const modal::ReducedModel& model, const ComplexShapes& shapes) {
  const auto n = model.mode_count();
  const auto p = shapes.outputs.rows();
  const auto q = shapes.inputs.cols();
  modal::StateSpace result;
  result.a.setZero(2 * n, 2 * n);
  result.b.setZero(2 * n, q);
  result.c.setZero(p, 2 * n);
  result.d = model.residual.size() > 0 ? model.residual : Eigen::MatrixXd::Zero(p, q);
  for (Eigen::Index m = 0; m < n; ++m) {
    if (m < model.rigid_count) {
      result.a(2 * m, 2 * m + 1) = 1.0;
      result.b.row(2 * m + 1) = shapes.inputs.row(m).real();
      result.c.col(2 * m) = shapes.outputs.col(m).real();
      continue;
    }
    const Complex own = pole(model, m);
    result.a.block<2, 2>(2 * m, 2 * m) << own.real(), own.imag(), -own.imag(), own.real();
    // l r / (s − p) and its conjugate: l (1, j)ᵀ and ½ (1, −j) r are the vectors of the block.
    const Complex root = std::sqrt(Complex(0.0, 2.0 * own.imag()));
    const Eigen::VectorXcd l = shapes.outputs.col(m) / root;
    const Eigen::RowVectorXcd r = shapes.inputs.row(m) / root;
    result.c.col(2 * m) = l.real();
    result.c.col(2 * m + 1) = l.imag();
    result.b.row(2 * m) = 2.0 * r.real();
    result.b.row(2 * m + 1) = -2.0 * r.imag();
  }
  return result;
}

}  // namespace chladni::identification
