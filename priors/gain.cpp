#include "priors/gain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/diagonal.h"
#include "base/error.h"
#include "base/search.h"
#include "priors/constants.h"
#include "priors/residual/random_coefficients.h"

namespace chladni::priors {
namespace {

constexpr double kNarrowest =
    1e-5;  // least width of a peak of ln β; matters if the noise is almost 0
constexpr int kFine = 80;

// [L; R] with both sides on one scale, and the functions at their places.
struct Sides {
  Eigen::MatrixXd rows;  // (s+a)×r, weighted
  Eigen::VectorXd values, noise;
  Eigen::Index sensors = 0;
};

double evidence_of(const Sides& sides, double log_gain, int sign) {
  Eigen::MatrixXd rows = sides.rows;
  rows.topRows(sides.sensors) *= std::exp(0.5 * log_gain);
  rows.bottomRows(rows.rows() - sides.sensors) *= sign * std::exp(-0.5 * log_gain);
  return RandomCoefficients(rows, sides.values, sides.noise).log_evidence();
}

struct Peak {
  double at = 0.0, height = 0.0, width = 1.0;
};

// The highest point; the curvature gives the width of the peak.
Peak peak_of(const Sides& sides, double centre, int sign) {
  const auto depth = [&](double at) { return -evidence_of(sides, at, sign); };
  const auto highest = minimum_in(depth, centre - Constants::gain_reach,
                                  centre + Constants::gain_reach, Constants::gain_intervals);
  Peak peak{highest.at, -highest.value};
  const double step = 1e-2;
  const double curvature = (2.0 * peak.height - evidence_of(sides, peak.at - step, sign) -
                            evidence_of(sides, peak.at + step, sign)) /
                           (step * step);
  peak.width = std::clamp(1.0 / std::sqrt(std::max(curvature, 1e-2)), kNarrowest, 2.0);
  return peak;
}

// Mean, deviation and mass of the evidence about a peak; the mass is relative to `reference`.
struct Moments {
  double mean = 0.0, deviation = 0.0, mass = 0.0;
};

Moments moments_of(const Sides& sides, const Peak& peak, int sign, double reference) {
  const double step = 10.0 * peak.width / kFine;
  Eigen::ArrayXd at(kFine + 1);
  Eigen::ArrayXd weight(kFine + 1);
  for (int k = 0; k <= kFine; ++k) {
    at(k) = peak.at + (k - kFine / 2) * step;
    weight(k) = std::exp(evidence_of(sides, at(k), sign) - reference);
  }
  Moments found;
  found.mass = weight.sum() * step;
  if (found.mass <= 0.0) return found;
  found.mean = (at * weight).sum() / weight.sum();
  found.deviation = std::sqrt(((at - found.mean).square() * weight).sum() / weight.sum());
  return found;
}

// 1 for one place and direction, −1 for opposite directions at one place, 0 for others.
double same_place(const Places& a, Eigen::Index i, const Places& b, Eigen::Index j, double near) {
  if ((a.position.row(i) - b.position.row(j)).norm() > near) return 0.0;
  for (const double sense : {1.0, -1.0}) {
    const double off = (a.direction.row(i) - sense * b.direction.row(j)).norm();
    if (off <= Constants::same_direction) return sense;
  }
  return 0.0;
}

// The distance below which two places of a body are one.
double nearness(const TwoSidedShape& shape) {
  Points places(shape.sensors.count() + shape.actuators.count(), 3);
  places << shape.sensors.position, shape.actuators.position;
  return Constants::same_place * diagonal_of(places);
}

// Functions of the higher modes: one for each place, shared by a collocated pair.
Eigen::MatrixXd functions_beyond(const TwoSidedShape& shape, double deviation) {
  const auto s = shape.sensors.count();
  const auto a = shape.actuators.count();
  const double near = nearness(shape);
  Eigen::MatrixXd functions = deviation * Eigen::MatrixXd::Identity(s + a, s + a);
  for (Eigen::Index k = 0; k < a; ++k) {
    for (Eigen::Index i = 0; i < s; ++i) {
      const double sense = same_place(shape.sensors, i, shape.actuators, k, near);
      if (sense == 0.0) continue;
      functions(s + k, s + k) = 0.0;
      functions(s + k, i) = sense * deviation;
      break;
    }
  }
  return functions;
}

Sides sides_of(const TwoSidedShape& shape, const ModalBasis& basis, const CoefficientPrior& known) {
  const auto& variance = known.variance;
  const auto r = variance.size();
  const auto s = shape.sensors.count();
  const auto a = shape.actuators.count();
  require(s > 0 && a > 0 && shape.sensor_values.size() == s && shape.sensor_noise.size() == s &&
              shape.actuator_values.size() == a && shape.actuator_noise.size() == a,
          "gain match: sensors or actuators are missing, or their values do not fit them");
  require(shape.sensors.shapes.cols() == r && shape.actuators.shapes.cols() == r,
          "gain match: the places do not carry the simulation's modes");
  Sides sides{Eigen::MatrixXd(s + a, r + s + a), Eigen::VectorXd(s + a), Eigen::VectorXd(s + a), s};
  sides.rows.topLeftCorner(s, r) = shape.sensors.shapes;
  sides.rows.bottomLeftCorner(a, r) = shape.actuators.shapes;
  sides.rows.leftCols(r) *= variance.cwiseSqrt().asDiagonal();
  const double shown = variance.dot(basis.gram.diagonal());
  sides.rows.rightCols(s + a) =
      functions_beyond(shape, std::sqrt(shown * known.beyond / (1.0 - known.beyond)));
  sides.values << shape.sensor_values, shape.actuator_values;
  sides.noise << shape.sensor_noise, shape.actuator_noise;
  return sides;
}

// ln β from the sizes of both sides only.
double rough_gain(const Sides& sides) {
  const auto actuators = sides.values.size() - sides.sensors;
  const double of_sensors =
      sides.values.head(sides.sensors).norm() / sides.rows.topRows(sides.sensors).norm();
  const double of_actuators =
      sides.values.tail(actuators).norm() / sides.rows.bottomRows(actuators).norm();
  require(of_sensors > 0.0 && of_actuators > 0.0 && std::isfinite(of_sensors / of_actuators),
          "gain match: a side sees nothing of the mode");
  return std::log(of_sensors / of_actuators);
}

}  // namespace

GainMatch gain_match(const TwoSidedShape& shape, const ModalBasis& basis,
                     const DynamicResidual& prior) {
  const auto known = coefficient_prior(basis, shape.frequency_hz, prior);
  const auto sides = sides_of(shape, basis, known);
  const double centre = rough_gain(sides);
  constexpr std::array kSigns{1, -1};
  std::array<Peak, 2> peaks;
  for (std::size_t i = 0; i < 2; ++i) peaks[i] = peak_of(sides, centre, kSigns[i]);
  const double highest = std::max(peaks[0].height, peaks[1].height);
  std::array<Moments, 2> moments;
  for (std::size_t i = 0; i < 2; ++i) {
    moments[i] = moments_of(sides, peaks[i], kSigns[i], highest);
  }
  const std::size_t best = moments[0].mass >= moments[1].mass ? 0 : 1;
  GainMatch match;
  match.log_gain = moments[best].mean;
  match.deviation = moments[best].deviation;
  match.sign = kSigns[best];
  match.certainty = moments[best].mass / (moments[0].mass + moments[1].mass);
  match.log_evidence = peaks[best].height;
  return match;
}

double log_gain_near(const TwoSidedShape& shape, const ModalBasis& basis,
                     const DynamicResidual& prior, const GainMatch& near) {
  const auto sides = sides_of(shape, basis, coefficient_prior(basis, shape.frequency_hz, prior));
  const double step = std::max(near.deviation, kNarrowest);
  const double below = evidence_of(sides, near.log_gain - step, near.sign);
  const double here = evidence_of(sides, near.log_gain, near.sign);
  const double above = evidence_of(sides, near.log_gain + step, near.sign);
  const double curvature = 2.0 * here - above - below;    // 1: that of `near`
  const double move = 0.5 * (above - below) / curvature;  // of Newton, in steps
  if (curvature > Constants::gain_bend && std::abs(move) < Constants::gain_move) {
    return near.log_gain + move * step;
  }
  const auto peak = peak_of(sides, near.log_gain, near.sign);
  for (const double end : {-Constants::gain_reach, Constants::gain_reach}) {
    if (!(peak.height - evidence_of(sides, near.log_gain + end, near.sign) >
          Constants::gain_peak)) {
      throw NumericalFailure("gain: the evidence has no peak about the gain that it is to be near");
    }
  }
  return peak.at;
}

}  // namespace chladni::priors
