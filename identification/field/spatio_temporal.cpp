#include "identification/spatio_temporal.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/turn.h"
#include "dense/algebra.h"
#include "identification/delay_scan.h"
#include "identification/field/mode_spread.h"
#include "identification/field/rigid_band.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

void check(const ModalFit& fit, const GainMatch& match, const PlacesOfInterest& places) {
  const auto m = fit.model.mode_count();
  require(places.shapes.cols() == m && places.deviation.rows() == places.shapes.rows() &&
              places.deviation.cols() == m && match.input_shapes.rows() == m &&
              places.residual.rows() == places.shapes.rows() &&
              places.residual.cols() == match.input_shapes.cols(),
          "predicted responses: shapes of " + fmt::to_string(places.shapes.cols()) +
              " modes, residual of " + fmt::to_string(places.residual.cols()) +
              " actuators; expected " + fmt::to_string(m) + " and " +
              fmt::to_string(match.input_shapes.cols()));
  require(places.residual_deviation.size() == 0 ||
              (places.residual_deviation.rows() == places.residual.rows() &&
               places.residual_deviation.cols() == places.residual.cols()),
          "predicted responses: deviations of the residual that do not fit it");
  const auto fits = [&](const Eigen::MatrixXd& part) {
    return part.rows() == (fit.complex ? places.shapes.rows() : 0) &&
           part.cols() == (fit.complex ? m : 0);
  };
  require(fits(places.imaginary) && fits(places.imaginary_deviation),
          fit.complex ? "predicted responses: complex shapes without imaginary parts"
                      : "predicted responses: imaginary parts of real shapes");
}

// 1/(s² + 2ζωs + ω²) of one mode and its derivatives by ω and ζ.
struct Resonance {
  Complex value, by_omega, by_damping;
};

Resonance resonance(double own, double ratio, double omega) {
  const Complex s(0.0, omega);
  const Complex value = 1.0 / (s * s + 2.0 * ratio * own * s + own * own);
  return {value, -value * value * (2.0 * ratio * s + 2.0 * own), -value * value * 2.0 * own * s};
}

// 1 / (2jω_d (s − p)): the factor of l r in a complex mode. The rest of the resonance is the factor
// of the conjugate of l r.
Complex half_resonance(double own, double ratio, double omega) {
  const double damped = own * std::sqrt(1.0 - ratio * ratio);
  const Complex pole(-ratio * own, damped);
  return 1.0 / (Complex(0.0, 2.0 * damped) * (Complex(0.0, omega) - pole));
}

// Variance of the delays of the sensors that were measured, about their mean [s²].
double scatter(const ModalFit& fit) {
  std::vector<double> known;
  for (Eigen::Index i = 0; i < fit.channel_delay_s.size(); ++i) {
    const bool is_known =
        fit.channel_delay_std_s.size() == 0 || std::isfinite(fit.channel_delay_std_s(i));
    if (is_known) known.push_back(fit.channel_delay_s(i));
  }
  if (known.size() < 2) return 0.0;
  const Eigen::Map<const Eigen::ArrayXd> all(known.data(), static_cast<Eigen::Index>(known.size()));
  return (all - all.mean()).square().sum() / static_cast<double>(known.size() - 1);
}

// Variances of these delays [s²]. At a place without a sensor the delays of outputs are known by
// their mean, about which those of the sensors that were measured scatter.
Eigen::VectorXd delay_variance(const ModalFit& fit) {
  const auto q = fit.model.input_count();
  if (fit.delay_of == DelayOf::inputs && fit.channel_delay_std_s.size() == q) {
    return fit.channel_delay_std_s.cwiseAbs2();
  }
  double variance = fit.delay_std_s * fit.delay_std_s;
  if (fit.delay_of == DelayOf::outputs) variance += scatter(fit);
  return Eigen::VectorXd::Constant(q, variance);
}

// Variance per actuator, divided by φ²: δG = φ (h δr + r h_ω δω + r h_ζ δζ).
Eigen::RowVectorXd input_variance(const Resonance& h, const ModeSpread& own,
                                  const Eigen::RowVectorXd& input) {
  Eigen::RowVectorXd result(input.size());
  for (Eigen::Index j = 0; j < input.size(); ++j) {
    const Eigen::Vector2cd slope = input(j) * Eigen::Vector2cd(h.by_omega, h.by_damping);
    const Complex pole = slope.dot(own.pole.cast<Complex>() * slope);
    const Complex mixed = std::conj(h.value) * Complex(own.mixed.row(j).cast<Complex>() * slope);
    result(j) = std::norm(h.value) * own.input(j) + pole.real() + 2.0 * mixed.real();
  }
  return result;
}

// n×m: by how much each shape moves with the error of its mode's scale.
Eigen::MatrixXd moved_with_scale(const PlacesOfInterest& places,
                                 const std::vector<ModeSpread>& spreads) {
  Eigen::MatrixXd moved = places.shapes;
  for (Eigen::Index m = 0; m < moved.cols(); ++m) {
    const double scale_std = spreads[static_cast<std::size_t>(m)].scale.deviation;
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
      moved(i, m) *= part_of_scale(moved(i, m), places.deviation(i, m), scale_std);
    }
  }
  return moved;
}

// Variance of the responses of one mode, n×q: δG = h (r δφ + φ δr + δφ δr) + φ r (h_ω δω + h_ζ δζ).
// δφ is φ times the scale's error, which goes with the rest, and a remainder that does not.
Eigen::MatrixXd mode_variance(const Resonance& h, const ModeSpread& own,
                              const Eigen::RowVectorXd& input, const Eigen::VectorXd& shape,
                              const Eigen::VectorXd& deviation, const Eigen::VectorXd& moved) {
  const double square = std::norm(h.value);
  Eigen::MatrixXd variance = shape.cwiseAbs2() * input_variance(h, own, input) +
                             square * deviation.cwiseAbs2() * (input.cwiseAbs2() + own.input);
  if (own.scale.deviation == 0.0) return variance;
  const Complex by_poles = h.by_omega * own.scale.pole(0) + h.by_damping * own.scale.pole(1);
  const Eigen::RowVectorXd with_rest = square * input.cwiseProduct(own.scale.input) +
                                       (std::conj(h.value) * by_poles).real() * input.cwiseAbs2();
  variance += 2.0 * shape.cwiseProduct(moved) * with_rest +
              2.0 * square * moved.cwiseAbs2() * own.scale.input.cwiseAbs2();
  return variance;
}

// Root of each variance. A variance below zero by rounding gives zero; an unknown one is infinite.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& variance) {
  return variance.unaryExpr([](double one) {
    return std::isfinite(one) ? std::sqrt(std::max(0.0, one))
                              : std::numeric_limits<double>::infinity();
  });
}

// n×q; 0 where no deviation is stated.
Eigen::MatrixXd residual_variance(const PlacesOfInterest& places) {
  if (places.residual_deviation.size() > 0) return places.residual_deviation.cwiseAbs2();
  return Eigen::MatrixXd::Zero(places.residual.rows(), places.residual.cols());
}

// K×nq; empty for real shapes.
Eigen::MatrixXcd complex_values(const ModalFit& fit, const GainMatch& match,
                                const PlacesOfInterest& places,
                                const Eigen::VectorXd& frequency_hz) {
  if (!fit.complex) return {};
  return responses(model_at(fit, match, places), complex_shapes_at(match, places), frequency_hz);
}

// `whole`: the resonances of all modes, K×m. `half`, for complex shapes only: the factors of l r.
struct Resonances {
  Eigen::MatrixXcd whole, half;
};

Resonances resonances(const ModalFit& fit, const Eigen::VectorXd& frequency_hz) {
  const auto m = fit.model.mode_count();
  Resonances all{Eigen::MatrixXcd(frequency_hz.size(), m), {}};
  if (fit.complex) all.half.resize(frequency_hz.size(), m);
  for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
    const double omega = kTwoPi * frequency_hz(k);
    for (Eigen::Index i = 0; i < m; ++i) {
      const double own = kTwoPi * fit.model.frequency_hz(i);
      const double ratio = fit.model.damping_ratio(i);
      all.whole(k, i) = resonance(own, ratio, omega).value;
      if (!fit.complex) continue;
      const bool rigid = i < fit.model.rigid_count;
      all.half(k, i) = rigid ? 0.5 * all.whole(k, i) : half_resonance(own, ratio, omega);
    }
  }
  return all;
}

// The matrix that gives the response to actuator j from a vector of unknowns: the row of
// shapes (for complex shapes first its real, then its imaginary parts), then the
// residual of each actuator.
Eigen::MatrixXcd row_columns(const Resonances& h, const GainMatch& match, Eigen::Index j) {
  const auto m = h.whole.cols();
  const bool complex = h.half.size() > 0;
  const auto shapes = complex ? 2 * m : m;
  Eigen::MatrixXcd columns =
      Eigen::MatrixXcd::Zero(h.whole.rows(), shapes + match.input_shapes.cols());
  columns.col(shapes + j).setOnes();
  if (!complex) {
    columns.leftCols(m) = h.whole * driving_shapes(match).col(j).asDiagonal();
    return columns;
  }
  const Eigen::VectorXcd r = driving_shapes(match).col(j).cast<Complex>() +
                             Complex(0.0, 1.0) * driving_imaginary(match).col(j);
  const Eigen::MatrixXcd with = h.half * r.asDiagonal();
  const Eigen::MatrixXcd against = (h.whole - h.half) * r.conjugate().asDiagonal();
  columns.leftCols(m) = with + against;
  columns.middleCols(m, m) = Complex(0.0, 1.0) * (with - against);
  return columns;
}

}  // namespace

PredictedResponses predicted(const ModalFit& fit, const GainMatch& match,
                             const PlacesOfInterest& places, const Eigen::VectorXd& frequency_hz) {
  check(fit, match, places);
  const auto& model = fit.model;
  require(model.rigid_count == 0 || frequency_hz.minCoeff() > 0.0,
          "predicted responses: a free body has no response at 0 Hz; leave that line out");
  const auto n = places.shapes.rows();
  const Eigen::MatrixXd inputs = driving_shapes(match);
  const auto spreads = mode_spreads(fit, match);
  const auto moved = moved_with_scale(places, spreads);
  const auto q = inputs.cols();
  PredictedResponses result;
  const auto delay = input_delays(fit);
  const Eigen::RowVectorXd late = delay_variance(fit).transpose();
  const auto rigid = rigid_variance(fit, match, places);
  const auto complex = complex_values(fit, match, places, frequency_hz);
  for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
    const double omega = kTwoPi * frequency_hz(k);
    Eigen::MatrixXcd value = fit.complex ? Eigen::MatrixXcd(complex.row(k).reshaped(n, q))
                                         : Eigen::MatrixXcd(places.residual.cast<Complex>());
    Eigen::MatrixXd variance = residual_variance(places);
    if (model.rigid_count > 0) variance += rigid / std::pow(omega, 4);
    for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
      const auto h = resonance(kTwoPi * model.frequency_hz(m), model.damping_ratio(m), omega);
      const Eigen::RowVectorXd input = inputs.row(m);
      if (!fit.complex) value += h.value * (places.shapes.col(m) * input).cast<Complex>();
      if (m < model.rigid_count) continue;
      variance += mode_variance(h, spreads[static_cast<std::size_t>(m)], input,
                                places.shapes.col(m), places.deviation.col(m), moved.col(m));
      if (!fit.complex) continue;
      const auto half =
          half_resonance(kTwoPi * model.frequency_hz(m), model.damping_ratio(m), omega);
      variance += std::norm(2.0 * half - h.value) * places.imaginary_deviation.col(m).cwiseAbs2() *
                  input.cwiseAbs2();
    }
    const double gain = places.gain_deviation * places.gain_deviation;
    variance.array() += value.cwiseAbs2().array().rowwise() * (omega * omega * late.array() + gain);
    for (Eigen::Index j = 0; j < q; ++j) value.col(j) *= std::polar(1.0, -omega * delay(j));
    result.value.emplace_back(std::move(value));
    result.deviation.emplace_back(root_of(variance));
  }
  return result;
}

double part_of_scale(double shape, double deviation, double scale_std) {
  const double open = std::abs(shape) * scale_std;
  return open > deviation ? deviation / open : 1.0;
}

Eigen::VectorXd input_delays(const ModalFit& fit) {
  Eigen::VectorXd all = Eigen::VectorXd::Constant(fit.model.input_count(), fit.delay_s);
  if (fit.delay_of == DelayOf::inputs) all += fit.channel_delay_s;
  return all;
}

modal::ReducedModel model_at(const ModalFit& fit, const GainMatch& match,
                             const PlacesOfInterest& places) {
  check(fit, match, places);
  modal::ReducedModel model = fit.model;
  model.output_shapes = places.shapes;
  model.input_shapes = driving_shapes(match);
  model.residual = places.residual;
  return model;
}

ComplexShapes complex_shapes_at(const GainMatch& match, const PlacesOfInterest& places) {
  ComplexShapes shapes;
  shapes.outputs = places.shapes.cast<Complex>() + Complex(0.0, 1.0) * places.imaginary;
  shapes.inputs =
      driving_shapes(match).cast<Complex>() + Complex(0.0, 1.0) * driving_imaginary(match);
  return shapes;
}

FittedRow fitted_row(const ModalFit& fit, const GainMatch& match, const FitData& measured) {
  const auto q = match.input_shapes.cols();
  require(measured.outputs == 1 && measured.inputs == q,
          "fitted row: " + fmt::to_string(measured.outputs) + " sensors by " +
              fmt::to_string(measured.inputs) + " actuators, expected 1 by " + fmt::to_string(q));
  const auto data = undelayed(measured, input_delays(fit));
  const auto m = fit.model.mode_count();
  const auto n = (fit.complex ? 2 * m : m) + q;
  const auto h = resonances(fit, data.frequency_hz);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < q; ++j) {
    const Eigen::MatrixXcd columns = row_columns(h, match, j);
    const Eigen::VectorXd w = data.weight.col(j).cwiseAbs2();
    const Eigen::MatrixXcd weighted = columns.adjoint() * w.cast<Complex>().asDiagonal();
    normal += (weighted * columns).real();
    right += (weighted * data.value.col(j)).real();
  }
  // Imaginary parts of rigid-body modes, and modes that no actuator drives here.
  const Eigen::ArrayX<bool> untold = normal.diagonal().array() == 0.0;
  normal.diagonal().array() += untold.cast<double>();
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(scale.asDiagonal() * normal * scale.asDiagonal()));
  const Eigen::VectorXd x =
      scale.cwiseProduct(factor.solve(Eigen::VectorXd(scale.cwiseProduct(right))));
  const Eigen::MatrixXd inverse = dense::inverse_of(factor);
  const Eigen::VectorXd deviation =
      untold.select(std::numeric_limits<double>::infinity(),
                    (0.5 * inverse.diagonal().cwiseMax(0.0)).cwiseSqrt().cwiseProduct(scale));
  return {x.head(m).transpose(), deviation.head(m).transpose(), x.tail(q).transpose()};
}

}  // namespace chladni::identification
