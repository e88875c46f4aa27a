#include "priors/residual/one_scale.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/finite.h"
#include "base/search.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

constexpr Eigen::Index kAmplitudeNodes = 13;  // of x
constexpr Eigen::Index kScaleNodes = 31;      // of δ
constexpr double kCertainScale = 1e-4;        // deviation of δ below which δ is 0
constexpr double kGridReach = 3.0;            // deviations
constexpr double kIgnoredWeight = 1e-7;       // of a node

double squared(double value) { return value * value; }

// Nodes of a standard normal variable; a single one is 0.
Eigen::ArrayXd normal_nodes(Eigen::Index count) {
  if (count == 1) return Eigen::ArrayXd::Zero(1);
  return Eigen::ArrayXd::LinSpaced(count, -kGridReach, kGridReach);
}

// ln of the nodes' probabilities.
Eigen::ArrayXd log_weights(const Eigen::ArrayXd& nodes) {
  return -0.5 * nodes.square() - std::log((-0.5 * nodes.square()).exp().sum());
}

Eigen::MatrixXd root_of_covariance(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(covariance, "one scale: covariance of a shape"));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

OneScale::OneScale(const MeasuredShapes& measured, const ModalBasis& basis)
    : measured_(measured), basis_(basis), mean_square_(basis.gram.diagonal().mean()) {}

OneScale::UnitPrior OneScale::unit_prior(Eigen::Index mode, const OneScaleErrors& errors) const {
  const double hz = measured_.frequency_hz(mode);
  const double highest = measured_.frequency_hz.maxCoeff();
  UnitPrior prior;
  if (highest > 0.0) {
    prior.own = squared(errors.deviation) * mean_square_ * std::sqrt(hz / highest);
  }
  const double lowest = basis_.frequency_hz.minCoeff();
  const auto variances = [&](const Eigen::VectorXd& frequency_hz) -> Eigen::VectorXd {
    return hz == 0.0 ? variances_at_rest(frequency_hz, lowest)
                     : coefficient_variances(frequency_hz, hz, errors.prior);
  };
  prior.variance = variances(basis_.frequency_hz);
  const double above = basis_.beyond_hz.size() > 0 ? variances(basis_.beyond_hz).sum() : 0.0;
  const double sum = prior.variance.sum() + above;
  prior.variance /= sum;
  prior.own += above * basis_.beyond_square / sum;
  return prior;
}

OneScale::AtScale OneScale::at_scale(Eigen::Index mode, const Eigen::MatrixXd& covariance,
                                     double delta) const {
  const Eigen::ArrayXd noise = measured_.sides->noise.col(mode);
  AtScale at{delta, Eigen::VectorXd(noise.size()), {}, {}, {}};
  for (Eigen::Index i = 0; i < noise.size(); ++i) {
    const bool actuator = measured_.sides->actuator[static_cast<std::size_t>(i)];
    at.factor(i) = std::exp(actuator ? -delta : delta) / noise(i);
  }
  const Eigen::MatrixXd whitened = at.factor.asDiagonal() * covariance * at.factor.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(whitened, "one scale: covariance of a shape's values"));
  at.directions = solver.eigenvectors();
  at.strength = solver.eigenvalues().cwiseMax(0.0);
  at.along = at.directions.transpose() * (measured_.values.col(mode).array() / noise).matrix();
  return at;
}

OneScale::Grid OneScale::grid(Eigen::Index mode, const OneScaleErrors& errors) const {
  Grid result{unit_prior(mode, errors), {}, {}, {}, 0.0};
  const auto& places = measured_.places.shapes;
  Eigen::MatrixXd covariance = places * result.prior.variance.asDiagonal() * places.transpose();
  covariance.diagonal().array() += result.prior.own;
  const double spread = measured_.sides->log_deviation(mode);
  const auto z = normal_nodes(spread > kCertainScale ? kScaleNodes : 1);
  const auto x = normal_nodes(kAmplitudeNodes);
  const Eigen::ArrayXd weight_z = log_weights(z);
  const Eigen::ArrayXd weight_x = log_weights(x);
  const double constant =
      measured_.sides->noise.col(mode).array().log().sum() +
      0.5 * std::log(2.0 * std::numbers::pi) * static_cast<double>(places.rows());
  result.amplitude = squared(errors.scale) * (Constants::amplitude_spread * x).exp();
  result.log_density.resize(z.size(), x.size());
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    result.scales.push_back(at_scale(mode, covariance, z(k) * spread));
    const auto& at = result.scales.back();
    for (Eigen::Index a = 0; a < x.size(); ++a) {
      const Eigen::ArrayXd total = 1.0 + result.amplitude(a) * at.strength.array();
      const double misfit = (at.along.array().square() / total).sum();
      result.log_density(k, a) =
          weight_z(k) + weight_x(a) - constant - 0.5 * (total.log().sum() + misfit);
    }
  }
  const double most = result.log_density.maxCoeff();
  result.log_evidence = most + std::log((result.log_density - most).exp().sum());
  return result;
}

double OneScale::log_evidence(const OneScaleErrors& errors) const {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < measured_.mode_count(); ++i) sum += grid(i, errors).log_evidence;
  return sum;
}

OneScaleErrors OneScale::learned() const {
  constexpr int kSweeps = 4;
  constexpr int kWide = 2;           // of them look far
  constexpr double kFarthest = 5.0;  // that these look, deviations
  constexpr int kScan = 14;          // intervals that these look at
  constexpr double kNear = 0.5;      // reach of the others, deviations
  // The scale with which the shapes have the size of the simulation's.
  const double scale = std::sqrt(measured_.values.squaredNorm() /
                                 (static_cast<double>(measured_.values.size()) * mean_square_));
  const ResidualPlausible plausible;
  Eigen::VectorXd middle(5);
  Eigen::VectorXd spread(5);
  middle << plausible.middle.head<3>(), scale, Constants::place_deviation;
  spread << plausible.spread.head<3>(), Constants::scale_spread, Constants::place_spread;
  const auto errors_at = [&](const Eigen::VectorXd& at) {
    const Eigen::ArrayXd value = middle.array() * (spread.array() * at.array()).exp();
    return OneScaleErrors{{value(0), value(1), value(2)}, value(3), value(4)};
  };
  Eigen::VectorXd at = Eigen::VectorXd::Zero(5);  // deviations from the middle
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const Eigen::Index k : {3, 4, 0, 2, 1}) {
      const auto implausibility = [&](double value) {
        Eigen::VectorXd moved = at;
        moved(k) = value;
        return 0.5 * moved.squaredNorm() - log_evidence(errors_at(moved));
      };
      at(k) = sweep < kWide ? minimum_in(implausibility, -kFarthest, kFarthest, kScan).at
                            : minimum_in(implausibility, at(k) - kNear, at(k) + kNear).at;
    }
  }
  return errors_at(at);
}

std::vector<OneScale::Plausible> OneScale::about(const OneScaleErrors& likeliest) const {
  constexpr Eigen::Index kErrorNodes = 7;
  constexpr double kErrorReach = 1.5;  // of ln η, on either side
  const ResidualPlausible plausible;
  std::vector<Plausible> all;
  Eigen::ArrayXd log_posterior(kErrorNodes);
  for (Eigen::Index k = 0; k < kErrorNodes; ++k) {
    auto errors = likeliest;
    errors.prior.eta *= std::exp(
        kErrorReach * (2.0 * static_cast<double>(k) / static_cast<double>(kErrorNodes - 1) - 1.0));
    const double away = std::log(errors.prior.eta / plausible.middle(0)) / plausible.spread(0);
    log_posterior(k) = log_evidence(errors) - 0.5 * away * away;
    all.push_back({errors, 0.0});
  }
  const Eigen::ArrayXd weight = (log_posterior - log_posterior.maxCoeff()).exp();
  for (Eigen::Index k = 0; k < kErrorNodes; ++k) {
    all[static_cast<std::size_t>(k)].probability = weight(k) / weight.sum();
  }
  return all;
}

ShapeCoefficients OneScale::shape(Eigen::Index mode, const std::vector<Plausible>& errors) const {
  const auto r = basis_.frequency_hz.size();
  ShapeCoefficients all{Eigen::VectorXd::Zero(r), {}, 0.0};
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(r, r);
  for (const auto& one : errors) {
    if (one.probability < kIgnoredWeight) continue;
    const auto found = shape(mode, one.errors);
    all.mean += one.probability * found.mean;
    all.beyond += one.probability * found.beyond;
    squares += one.probability *
               (found.root * found.root.transpose() + found.mean * found.mean.transpose());
  }
  all.root = root_of_covariance(squares - all.mean * all.mean.transpose());
  return all;
}

ShapeCoefficients OneScale::shape(Eigen::Index mode, const OneScaleErrors& errors) const {
  const auto known = grid(mode, errors);
  const auto& prior = known.prior;
  const auto r = prior.variance.size();
  ShapeCoefficients shape{Eigen::VectorXd::Zero(r), {}, 0.0};
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(r, r);  // second moments
  for (Eigen::Index k = 0; k < std::ssize(known.scales); ++k) {
    const auto& at = known.scales[static_cast<std::size_t>(k)];
    const double side = std::exp(at.delta);
    const Eigen::MatrixXd with =
        side * (prior.variance.asDiagonal() * measured_.places.shapes.transpose() *
                at.factor.asDiagonal() * at.directions);
    for (Eigen::Index a = 0; a < known.amplitude.size(); ++a) {
      const double weight = std::exp(known.log_density(k, a) - known.log_evidence);
      if (weight < kIgnoredWeight) continue;
      const double amplitude = known.amplitude(a);
      const Eigen::VectorXd gain = amplitude / (1.0 + amplitude * at.strength.array());
      const Eigen::VectorXd mean = with * gain.cwiseProduct(at.along);
      shape.mean += weight * mean;
      squares += weight * (mean * mean.transpose() -
                           amplitude * (with * gain.asDiagonal() * with.transpose()));
      squares.diagonal() += weight * squared(side) * amplitude * prior.variance;
      shape.beyond += weight * squared(side) * amplitude * prior.own;
    }
  }
  shape.root = root_of_covariance(squares - shape.mean * shape.mean.transpose());
  return shape;
}

}  // namespace chladni::priors
