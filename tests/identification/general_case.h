// The truth of a record with a dashpot in one place: complex modes as a fit states them, and the
// Cramer-Rao bound of a model of such modes. Written from the formulas, with no code of the fit's.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "simulators/frf_cases.h"

namespace chladni::identification {

/// Complex modes: pole and L, R with |L| = |R|, Im(Σ L² + conj Σ R²) = 0, the largest Re L
/// positive; G = Σ L R / (2j Im(p) (s − p)) + conjugate.
struct GeneralTruth {
  Eigen::VectorXcd pole;
  Eigen::MatrixXcd outputs, inputs;
};

inline GeneralTruth general_truth(const simulators::FrfCase& made) {
  const auto modes = simulators::complex_modes(made.truth);
  GeneralTruth truth{modes.pole, modes.outputs, modes.inputs};
  for (Eigen::Index m = 0; m < modes.pole.size(); ++m) {
    auto l = truth.outputs.col(m);
    auto r = truth.inputs.row(m);
    l *= std::complex<double>(0.0, 2.0 * modes.pole(m).imag());
    const double size = std::sqrt(r.norm() / l.norm());
    const std::complex<double> sum = size * size * (l.transpose() * l).value() +
                                     std::conj((r * r.transpose()).value()) / (size * size);
    std::complex<double> factor = size * std::polar(1.0, -0.5 * std::arg(sum));
    Eigen::Index largest = 0;
    (factor * l).real().cwiseAbs().maxCoeff(&largest);
    if ((factor * l(largest)).real() < 0.0) factor = -factor;
    l *= factor;
    r /= factor;
  }
  return truth;
}

struct GeneralBounds {
  Eigen::VectorXd frequency_hz, damping;  ///< standard deviations
  Eigen::VectorXd shape;                  ///< of all of L R, root of the sum over its entries
};

/// Fisher information of (Re p, Im p, Re l, Im l, Re r, Im r) of all modes and a constant each
/// response, pseudo-inverted.
inline GeneralBounds general_bounds(const simulators::FrfCase& made, const GeneralTruth& truth) {
  using Complex = std::complex<double>;
  const Complex j(0.0, 1.0);
  const auto p = truth.outputs.rows();
  const auto q = truth.inputs.cols();
  const auto n = truth.pole.size();
  const auto own = 2 + 2 * (p + q);
  const auto all = n * own + p * q;
  Eigen::MatrixXd fisher = Eigen::MatrixXd::Zero(all, all);
  for (std::size_t k = 0; k < made.measured.value.size(); ++k) {
    const Complex s =
        2.0 * std::numbers::pi * j * made.measured.frequency_hz(static_cast<Eigen::Index>(k));
    for (Eigen::Index a = 0; a < p; ++a) {
      for (Eigen::Index b = 0; b < q; ++b) {
        Eigen::VectorXcd slope = Eigen::VectorXcd::Zero(all);
        for (Eigen::Index m = 0; m < n; ++m) {
          const Complex pole = truth.pole(m);
          const Complex over = 1.0 / (2.0 * j * pole.imag());
          const Complex l = truth.outputs(a, m) * over;
          const Complex r = truth.inputs(m, b);
          const auto put = [&](Eigen::Index at, Complex f, Complex conjugate) {
            slope(m * own + at) = f + conjugate;            // by the real part
            slope(m * own + at + 1) = j * (f - conjugate);  // by the imaginary one
          };
          const Complex f = 1.0 / (s - pole);
          const Complex g = 1.0 / (s - std::conj(pole));
          put(0, l * r * f * f, std::conj(l * r) * g * g);
          put(2 + 2 * a, over * r * f, std::conj(over * r) * g);
          put(2 + 2 * (p + b), l * f, std::conj(l) * g);
        }
        slope(n * own + a + p * b) = 1.0;
        const double weight = 2.0 / made.measured.variance[k](a, b);
        fisher += weight * (slope.conjugate() * slope.transpose()).real();
      }
    }
  }
  const Eigen::VectorXd unit = fisher.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(unit.asDiagonal() * fisher * unit.asDiagonal()));
  Eigen::VectorXd inverse = solver.eigenvalues().cwiseInverse();
  inverse.head(2 * n).setZero();  // the complex factors between both sides
  const Eigen::MatrixXd covariance = unit.asDiagonal() * solver.eigenvectors() *
                                     inverse.asDiagonal() * solver.eigenvectors().transpose() *
                                     unit.asDiagonal();
  GeneralBounds bounds{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index m = 0; m < n; ++m) {
    const Eigen::Matrix2d pole = covariance.block<2, 2>(m * own, m * own);
    const double size = std::abs(truth.pole(m));
    const double real = truth.pole(m).real();
    const double imaginary = truth.pole(m).imag();
    const Eigen::Vector2d omega(real / size, imaginary / size);
    const Eigen::Vector2d ratio = Eigen::Vector2d(-1.0 / size, 0.0) + real / (size * size) * omega;
    bounds.frequency_hz(m) = std::sqrt(omega.dot(pole * omega)) / (2.0 * std::numbers::pi);
    bounds.damping(m) = std::sqrt(ratio.dot(pole * ratio));
    Eigen::MatrixXcd change = Eigen::MatrixXcd::Zero(p * q, own - 2);  // of L R
    for (Eigen::Index a = 0; a < p; ++a) {
      for (Eigen::Index b = 0; b < q; ++b) {
        change(a + p * b, 2 * a) = truth.inputs(m, b);
        change(a + p * b, 2 * a + 1) = j * truth.inputs(m, b);
        change(a + p * b, 2 * (p + b)) = truth.outputs(a, m);
        change(a + p * b, 2 * (p + b) + 1) = j * truth.outputs(a, m);
      }
    }
    const Eigen::MatrixXd sides = covariance.block(m * own + 2, m * own + 2, own - 2, own - 2);
    bounds.shape(m) = std::sqrt((change * sides * change.adjoint()).trace().real());
  }
  return bounds;
}

}  // namespace chladni::identification
