#include "priors/residual/residual_evidence.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "priors/constants.h"
#include "priors/gaussian_process/optimum.h"
#include "priors/residual/random_coefficients.h"

namespace chladni::priors {
namespace {

// Frequencies of the modes above the last one. They grow with the power of the mode number that the
// upper half shows, between that of a cubic body and that of a bar.
Eigen::VectorXd frequencies_beyond(const Eigen::VectorXd& frequency_hz, Eigen::Index rigid) {
  const Eigen::Index flexible = frequency_hz.size() - rigid;
  if (flexible < 4) return {};
  const double last = frequency_hz(frequency_hz.size() - 1);
  const double half = frequency_hz(rigid + flexible / 2 - 1);
  const double octaves =
      std::log(static_cast<double>(flexible) / static_cast<double>(flexible / 2));
  const double power = std::clamp(std::log(last / half) / octaves, 1.0 / 3.0, 2.0);
  Eigen::VectorXd beyond(Constants::modes_beyond);
  for (Eigen::Index j = 0; j < Constants::modes_beyond; ++j) {
    beyond(j) =
        last * std::pow(1.0 + static_cast<double>(j + 1) / static_cast<double>(flexible), power);
  }
  return beyond;
}

// Derivatives of ln q by ln η, ln κ, ln γ; r×3.
Eigen::MatrixXd variance_slopes(const Eigen::VectorXd& frequency_hz, double real_hz,
                                const DynamicResidual& prior) {
  const Eigen::ArrayXd r = prior.gamma * (frequency_hz / real_hz).array().square();
  const Eigen::ArrayXd resonance = (r - 1.0).square() + prior.eta * prior.eta;
  Eigen::MatrixXd slopes(r.size(), 3);
  slopes.col(0) = -2.0 * prior.eta * prior.eta / resonance;
  slopes.col(1) = prior.kappa / (r + prior.kappa);
  slopes.col(2) = r / (r + prior.kappa) - 2.0 * r * (r - 1.0) / resonance;
  return slopes;
}

// @param q, slopes  variances of the higher modes, and the slopes of their logarithms
void add_beyond(const ModalBasis& basis, const Eigen::VectorXd& q, const Eigen::MatrixXd& slopes,
                CoefficientPrior& known) {
  if (q.size() == 0) return;
  const double above = basis.beyond_square * q.sum();
  const Eigen::Vector3d above_slopes = basis.beyond_square * slopes.transpose() * q;
  const Eigen::VectorXd squares = known.variance.cwiseProduct(basis.gram.diagonal());
  const double below = squares.sum();
  const Eigen::Vector3d below_slopes = known.slopes.transpose() * squares;
  const double sum = above + below;
  known.beyond = above / sum;
  known.beyond_slopes = (above_slopes * below - above * below_slopes) / (sum * sum);
}

ResidualErrors errors_of(const Eigen::Vector4d& logarithms) {
  const Eigen::Vector4d value = logarithms.array().exp();
  return {{value(0), value(1), value(2)}, value(3)};
}

// Divided differences of q(λ) and of λ q(λ) between the simulation's eigenvalues λ_a and λ_b, r×r,
// without cancellation for close eigenvalues.
struct DividedDifferences {
  Eigen::MatrixXd q, lambda_q;
};

DividedDifferences divided_differences(const Eigen::VectorXd& frequency_hz, double real_hz,
                                       const DynamicResidual& prior) {
  const auto r = frequency_hz.size();
  if (real_hz == 0.0) {
    const double lowest = frequency_hz.minCoeff();
    const Eigen::VectorXd q = variances_at_rest(frequency_hz, lowest);
    // On a free body q is 1 at 0 and 0 elsewhere, on a held one λ_1/λ.
    if (lowest == 0.0) return {Eigen::MatrixXd::Zero(r, r), q * q.transpose()};
    const double first = std::pow(2.0 * std::numbers::pi * lowest, 2);
    return {-q * q.transpose() / first, Eigen::MatrixXd::Zero(r, r)};
  }
  const double scale = prior.gamma / std::pow(2.0 * std::numbers::pi * real_hz, 2);
  const Eigen::ArrayXd ratio = prior.gamma * (frequency_hz / real_hz).array().square();
  const Eigen::ArrayXd above = ratio + prior.kappa;
  const Eigen::ArrayXd below = (ratio - 1.0).square() + prior.eta * prior.eta;
  DividedDifferences found{Eigen::MatrixXd(r, r), Eigen::MatrixXd(r, r)};
  for (Eigen::Index b = 0; b < r; ++b) {
    for (Eigen::Index a = 0; a < r; ++a) {
      const double q = (below(a) - above(a) * (ratio(a) + ratio(b) - 2.0)) / (below(a) * below(b));
      found.q(a, b) = scale * q;
      found.lambda_q(a, b) = above(a) / below(a) + ratio(b) * q;
    }
  }
  return found;
}

// The contribution of one shape to the pooled evidence.
PooledEvidence evidence_of(const MeasuredShapes& measured, const ModalBasis& basis,
                           Eigen::Index mode, const ResidualErrors& errors, bool matrix_slopes) {
  const auto known = coefficient_prior(basis, measured.frequency_hz(mode), errors.prior);
  const auto deviation = deviation_of_values(measured, mode, errors.noise, known.beyond);
  const RandomCoefficients shape(measured.places.shapes * known.variance.cwiseSqrt().asDiagonal(),
                                 measured.values.col(mode), deviation);
  PooledEvidence evidence;
  evidence.log_evidence = shape.log_evidence();
  evidence.slopes.head<3>() = known.slopes.transpose() * shape.variance_slopes();
  // σ² = (noise σ0)² + beyond v: slopes by ln noise and by `beyond`.
  const Eigen::ArrayXd of_noise = shape.noise_slopes();
  const Eigen::ArrayXd variance = deviation.array().square();
  const double square =
      measured.values.col(mode).squaredNorm() / static_cast<double>(measured.values.rows());
  const Eigen::ArrayXd own = (errors.noise * measured.noise.col(mode).array()).square();
  const double of_beyond = (of_noise * 0.5 * square / variance).sum();
  evidence.slopes.head<3>() += of_beyond * known.beyond_slopes;
  evidence.slopes(3) = (of_noise * own / variance).sum();
  if (!matrix_slopes) return evidence;
  // The prior's covariance T q Tᵀ changes with the eigenvectors T of (λ + dK, I + dM).
  Eigen::MatrixXd of_covariance = shape.covariance_slopes(measured.places.shapes);
  if (known.beyond > 0.0) {
    const double seen = known.variance.dot(basis.gram.diagonal());
    of_covariance -= of_beyond * known.beyond * (1.0 - known.beyond) / seen * basis.gram;
  }
  const auto differences =
      divided_differences(basis.frequency_hz, measured.frequency_hz(mode), errors.prior);
  evidence.stiffness_slopes = of_covariance.cwiseProduct(differences.q);
  evidence.mass_slopes = -of_covariance.cwiseProduct(differences.lambda_q);
  return evidence;
}

}  // namespace

ModalBasis modal_basis(const Simulation& simulation) {
  ModalBasis basis;
  basis.frequency_hz = simulation.frequency_hz;
  const auto& shapes = simulation.surface.shapes;
  const Eigen::MatrixXd weighted = (simulation.area / simulation.area.sum()).asDiagonal() * shapes;
  basis.gram = shapes.transpose() * weighted;
  const auto rigid = simulation.rigid_count();
  basis.beyond_hz = frequencies_beyond(basis.frequency_hz, rigid);
  if (basis.beyond_hz.size() > 0) {
    basis.beyond_square = basis.gram.diagonal().tail(simulation.mode_count() - rigid).mean();
  }
  return basis;
}

Eigen::VectorXd variances_at_rest(const Eigen::VectorXd& frequency_hz, double lowest_hz) {
  if (lowest_hz == 0.0) return (frequency_hz.array() == 0.0).cast<double>();
  return (lowest_hz / frequency_hz.array()).square();
}

CoefficientPrior coefficient_prior(const ModalBasis& basis, double real_hz,
                                   const DynamicResidual& prior) {
  CoefficientPrior known;
  const auto r = basis.frequency_hz.size();
  const auto above = basis.beyond_hz.size();
  if (real_hz == 0.0) {
    const double lowest = basis.frequency_hz.minCoeff();
    known.variance = variances_at_rest(basis.frequency_hz, lowest);
    known.slopes.setZero(r, 3);
    add_beyond(basis, variances_at_rest(basis.beyond_hz, lowest), Eigen::MatrixXd::Zero(above, 3),
               known);
    return known;
  }
  known.variance = coefficient_variances(basis.frequency_hz, real_hz, prior);
  known.slopes = variance_slopes(basis.frequency_hz, real_hz, prior);
  if (above == 0) return known;
  add_beyond(basis, coefficient_variances(basis.beyond_hz, real_hz, prior),
             variance_slopes(basis.beyond_hz, real_hz, prior), known);
  return known;
}

Eigen::VectorXd deviation_of_values(const MeasuredShapes& measured, Eigen::Index mode, double noise,
                                    double beyond) {
  const double square =
      measured.values.col(mode).squaredNorm() / static_cast<double>(measured.values.rows());
  return ((noise * measured.noise.col(mode).array()).square() + beyond * square).sqrt();
}

PooledEvidence pooled_evidence(const MeasuredShapes& measured, const ModalBasis& basis,
                               const ResidualErrors& errors, bool matrix_slopes) {
  PooledEvidence pooled;
  if (matrix_slopes) {
    const auto r = basis.frequency_hz.size();
    pooled.stiffness_slopes.setZero(r, r);
    pooled.mass_slopes.setZero(r, r);
  }
  for (Eigen::Index i = 0; i < measured.mode_count(); ++i) {
    const auto evidence = evidence_of(measured, basis, i, errors, matrix_slopes);
    pooled.log_evidence += evidence.log_evidence;
    pooled.slopes += evidence.slopes;
    if (!matrix_slopes) continue;
    pooled.stiffness_slopes += evidence.stiffness_slopes;
    pooled.mass_slopes += evidence.mass_slopes;
  }
  return pooled;
}

std::vector<std::string> doubts_of(const ResidualErrors& errors,
                                   const ResidualPlausible& plausible) {
  constexpr std::array kNames{"eta (relative error of the squared frequencies)",
                              "kappa (errors of the mass against those of the stiffness)",
                              "gamma (real stiffness per mass over the simulation's)",
                              "the noise over the stated one"};
  const Eigen::Vector4d values{errors.prior.eta, errors.prior.kappa, errors.prior.gamma,
                               errors.noise};
  std::vector<std::string> doubts;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double middle = plausible.middle(k);
    const double away = std::log(values(k) / middle) / plausible.spread(k);
    if (std::abs(away) < Constants::doubtful) continue;
    doubts.push_back(fmt::format(
        "{} is {:.3g}, far from the plausible {:.3g} (a factor {:.2g} "
        "either way): the simulation or the data may be wrong",
        kNames[static_cast<std::size_t>(k)], values(k), middle, std::exp(plausible.spread(k))));
  }
  return doubts;
}

LearnedErrors learned_errors(const MeasuredShapes& measured, const ModalBasis& basis,
                             const ResidualPlausible& plausible) {
  const Eigen::Vector4d middle = plausible.middle.array().log();
  const Eigen::Vector4d weight = plausible.spread.array().square().inverse();
  LearnedErrors learned;
  const Objective implausibility = [&](const Eigen::VectorXd& logarithms, Eigen::VectorXd& slopes) {
    const auto pooled = pooled_evidence(measured, basis, errors_of(logarithms));
    const Eigen::Vector4d away = logarithms - middle;
    slopes = weight.cwiseProduct(away) - pooled.slopes;
    ++learned.evaluations;
    return 0.5 * weight.dot(away.cwiseAbs2()) - pooled.log_evidence;
  };
  const Eigen::Vector4d range = 4.0 * plausible.spread;
  // Only γ has several peaks: the search starts at the best of a few values.
  Eigen::VectorXd start = middle;
  Eigen::VectorXd unused = middle;
  double least = std::numeric_limits<double>::infinity();
  for (const double stiffness : {0.35, 0.5, 0.7, 1.0, 1.4}) {
    Eigen::VectorXd at = middle;
    at(2) = std::log(stiffness);
    const double value = implausibility(at, unused);
    if (value >= least) continue;
    least = value;
    start = at;
  }
  const auto best = minimum(implausibility, start, middle - range, middle + range, {1e-3, 200});
  learned.errors = errors_of(best.at);
  learned.log_evidence = pooled_evidence(measured, basis, learned.errors).log_evidence;
  learned.doubts = doubts_of(learned.errors, plausible);
  return learned;
}

}  // namespace chladni::priors
