#include "identification/spatio_temporal.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "base/error.h"
#include "identification/delay_scan.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

void refuse_complex_shapes(const ModalFit& fit) {
  require(
      !fit.complex,
      "predicted responses: the fit has complex shapes, of general damping; expected real ones, "
      "of modal damping");
}

void check(const ModalFit& fit, const GainMatch& match, const PlacesOfInterest& places) {
  refuse_complex_shapes(fit);
  const auto m = fit.model.mode_count();
  require(places.shapes.cols() == m && places.deviation.rows() == places.shapes.rows() &&
              places.deviation.cols() == m && match.input_shapes.rows() == m &&
              places.residual.rows() == places.shapes.rows() &&
              places.residual.cols() == match.input_shapes.cols(),
          "predicted responses: shapes of " + std::to_string(places.shapes.cols()) +
              " modes, residual of " + std::to_string(places.residual.cols()) +
              " actuators; expected " + std::to_string(m) + " and " +
              std::to_string(match.input_shapes.cols()));
}

// 1/(s² + 2ζωs + ω²) of one mode and its slopes with ω and ζ.
struct Resonance {
  Complex value, by_omega, by_damping;
};

Resonance resonance(double own, double ratio, double omega) {
  const Complex s(0.0, omega);
  const Complex value = 1.0 / (s * s + 2.0 * ratio * own * s + own * own);
  return {value, -value * value * (2.0 * ratio * s + 2.0 * own), -value * value * 2.0 * own * s};
}

// Deviations of ω, ζ and the input vector of a mode, as the match has scaled it.
struct ModeSpread {
  Eigen::Matrix2d pole = Eigen::Matrix2d::Zero();
  Eigen::RowVectorXd input;  // q: variances
  Eigen::MatrixX2d mixed;    // q×2: covariances with ω and ζ
};

ModeSpread spread(const ModalFit& fit, const GainMatch& match, Eigen::Index m) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  const auto& all = fit.mode_covariance[static_cast<std::size_t>(m)];
  const auto& fitted = fit.model.input_shapes.row(m);
  const double square = fitted.squaredNorm();
  const double gain = square > 0.0 ? match.input_shapes.row(m).dot(fitted) / square : 1.0;
  ModeSpread result;
  result.pole = all.topLeftCorner<2, 2>();
  result.input = gain * gain * all.diagonal().tail(q).transpose();
  result.mixed = gain * all.block(2 + p, 0, q, 2);
  return result;
}

// Of a place that no sensor measured, per actuator: delays of outputs count with their mean.
Eigen::VectorXd input_delays(const ModalFit& fit) {
  Eigen::VectorXd all = Eigen::VectorXd::Constant(fit.model.input_count(), fit.delay_s);
  if (fit.delay_of == DelayOf::inputs) all += fit.channel_delay_s;
  return all;
}

}  // namespace

PredictedResponses predicted(const ModalFit& fit, const GainMatch& match,
                             const PlacesOfInterest& places, const Eigen::VectorXd& frequency_hz) {
  check(fit, match, places);
  const auto& model = fit.model;
  require(model.rigid_count == 0 || frequency_hz.minCoeff() > 0.0,
          "predicted responses: a free body has no response at 0 Hz; leave that line out");
  const auto n = places.shapes.rows();
  const auto q = match.input_shapes.cols();
  std::vector<ModeSpread> spreads;
  for (Eigen::Index m = 0; m < model.mode_count(); ++m) spreads.push_back(spread(fit, match, m));
  PredictedResponses result;
  const auto delay = input_delays(fit);
  for (const double f : frequency_hz) {
    const double omega = kTwoPi * f;
    Eigen::MatrixXcd value = places.residual.cast<Complex>();
    Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(n, q);
    for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
      const auto h = resonance(kTwoPi * model.frequency_hz(m), model.damping_ratio(m), omega);
      const auto& own = spreads[static_cast<std::size_t>(m)];
      const auto& input = match.input_shapes.row(m);
      value += h.value * (places.shapes.col(m) * input).cast<Complex>();
      // Per actuator: δG = φ (h δr + r h_ω δω + r h_ζ δζ), beside δφ h r.
      Eigen::RowVectorXd per_input(q);
      for (Eigen::Index j = 0; j < q; ++j) {
        const Eigen::Vector2cd slope = input(j) * Eigen::Vector2cd(h.by_omega, h.by_damping);
        const Complex pole = slope.dot(own.pole.cast<Complex>() * slope);
        const Complex mixed =
            std::conj(h.value) * Complex(own.mixed.row(j).cast<Complex>() * slope);
        per_input(j) = std::norm(h.value) * own.input(j) + pole.real() + 2.0 * mixed.real();
      }
      variance += places.shapes.col(m).cwiseAbs2() * per_input.cwiseMax(0.0) +
                  std::norm(h.value) * places.deviation.col(m).cwiseAbs2() * input.cwiseAbs2();
    }
    for (Eigen::Index j = 0; j < q; ++j) value.col(j) *= std::polar(1.0, -omega * delay(j));
    result.value.emplace_back(std::move(value));
    result.deviation.emplace_back(variance.cwiseSqrt());
  }
  return result;
}

modal::ReducedModel model_at(const ModalFit& fit, const GainMatch& match,
                             const PlacesOfInterest& places) {
  check(fit, match, places);
  modal::ReducedModel model = fit.model;
  model.output_shapes = places.shapes;
  model.input_shapes = match.input_shapes;
  model.residual = places.residual;
  return model;
}

FittedRow fitted_row(const ModalFit& fit, const GainMatch& match, const FitData& measured) {
  refuse_complex_shapes(fit);
  const auto q = match.input_shapes.cols();
  require(measured.outputs == 1 && measured.inputs == q,
          "fitted row: " + std::to_string(measured.outputs) + " sensors by " +
              std::to_string(measured.inputs) + " actuators, expected 1 by " + std::to_string(q));
  const auto data = undelayed(measured, input_delays(fit));
  const auto m = fit.model.mode_count();
  const auto lines = data.line_count();
  Eigen::MatrixXcd h(lines, m);
  for (Eigen::Index k = 0; k < lines; ++k) {
    for (Eigen::Index i = 0; i < m; ++i) {
      h(k, i) = resonance(kTwoPi * fit.model.frequency_hz(i), fit.model.damping_ratio(i),
                          kTwoPi * data.frequency_hz(k))
                    .value;
    }
  }
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(m + q, m + q);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(m + q);
  for (Eigen::Index j = 0; j < q; ++j) {
    Eigen::MatrixXcd columns = Eigen::MatrixXcd::Zero(lines, m + q);
    columns.leftCols(m) = h * match.input_shapes.col(j).asDiagonal();
    columns.col(m + j).setOnes();
    const Eigen::VectorXd w = data.weight.col(j).cwiseAbs2();
    const Eigen::MatrixXcd weighted = columns.adjoint() * w.cast<Complex>().asDiagonal();
    normal += (weighted * columns).real();
    right += (weighted * data.value.col(j)).real();
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(scale.asDiagonal() * normal * scale.asDiagonal()));
  const Eigen::VectorXd x = scale.cwiseProduct(factor.solve(scale.cwiseProduct(right)));
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(m + q, m + q));
  const Eigen::VectorXd deviation =
      (0.5 * inverse.diagonal().cwiseMax(0.0)).cwiseSqrt().cwiseProduct(scale);
  return {x.head(m).transpose(), deviation.head(m).transpose(), x.tail(q).transpose()};
}

}  // namespace chladni::identification
