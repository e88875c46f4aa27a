#include "identification/poles/mode_choice.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/finite.h"
#include "identification/constants.h"
#include "identification/poles/completion.h"

namespace chladni::identification {
namespace {

using std::numbers::pi;

bool looks_like_a_mode(const std::complex<double>& pole, const FitData& data) {
  const double own = std::abs(pole) / (2.0 * pi);
  return -pole.real() < Constants::most_damping * std::abs(pole) &&
         own > Constants::below_band * data.frequency_hz(0) &&
         own < Constants::above_band * data.frequency_hz(data.line_count() - 1);
}

// Usual damping of the poles: mean of its logarithm, weighted by their worth.
double usual_damping(const Eigen::VectorXcd& poles, const Eigen::VectorXd& worth) {
  const Eigen::VectorXd log_ratio =
      (-poles.real().array() / poles.cwiseAbs().array()).max(1e-12).log();
  return std::exp(worth.dot(log_ratio) / worth.sum());
}

// Mean distance between lines [rad/s].
double line_spacing(const FitData& data) {
  return 2.0 * pi * (data.frequency_hz(data.line_count() - 1) - data.frequency_hz(0)) /
         static_cast<double>(data.line_count() - 1);
}

// Removes poles that measured data draw without a mode: leakage, drift between hits and
// nonlinearity give poles near a resonance, or broad ones below it. This applies where no variance
// is stated. A pole of a hundredth of another's worth is removed if it is within three bandwidths
// of either or ten lines, or anywhere if its damping is ten times the usual one.
std::vector<Eigen::Index> without_satellites(const FitData& data, const ResidueProblem& problem,
                                             const Eigen::VectorXcd& poles,
                                             const std::vector<Eigen::Index>& candidates) {
  if (data.noise_stated || candidates.empty()) return candidates;
  const auto worth = problem.residues(candidates).significance;
  const Eigen::VectorXcd p = poles(candidates);
  const double usual = usual_damping(p, worth);
  const double lines = Constants::satellite_lines * line_spacing(data);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index a = 0; a < p.size(); ++a) {
    const bool broad = -p(a).real() > Constants::broad * usual * std::abs(p(a));
    bool alone = true;
    for (Eigen::Index b = 0; b < p.size(); ++b) {
      const double near =
          std::max(lines, -2.0 * Constants::satellite_reach * std::min(p(a).real(), p(b).real()));
      const bool weak = worth(a) < Constants::satellite_worth * worth(b);
      alone = alone && !(weak && (broad || std::abs(p(a).imag() - p(b).imag()) < near));
    }
    if (alone) kept.push_back(candidates[static_cast<std::size_t>(a)]);
  }
  return kept;
}

}  // namespace

double least_significance(const FitData& data, double cost) {
  return Constants::least_worth * static_cast<double>(data.outputs + data.inputs) *
         noise_level(data, cost);
}

Eigen::VectorXcd worthwhile(const FitData& data, const ResidueProblem& problem,
                            const Eigen::VectorXcd& poles, Eigen::Index modes) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    if (looks_like_a_mode(poles(i), data)) kept.push_back(i);
  }
  if (modes == 0) kept = without_satellites(data, problem, poles, kept);
  // The residual of the fit with all poles gives the level of the noise.
  const double least = least_significance(data, problem.residues().cost);
  while (!kept.empty()) {
    Eigen::Index weakest = 0;
    const double worth = problem.residues(kept).significance.minCoeff(&weakest);
    const auto count = static_cast<Eigen::Index>(kept.size());
    if (modes > 0 ? count <= modes : worth >= least) break;
    kept.erase(kept.begin() + weakest);
  }
  return poles(kept);
}

Eigen::VectorXcd strongest(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  const auto worth = ResidueProblem(data, poles, rigid).residues().significance;
  const double lines = Constants::strongest_lines * line_spacing(data);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index a = 0; a < poles.size(); ++a) {
    bool alone = true;
    for (Eigen::Index b = 0; b < poles.size(); ++b) {
      const double near = std::max(
          lines, -2.0 * Constants::satellite_reach * std::max(poles(a).real(), poles(b).real()));
      alone = alone && !(worth(a) < worth(b) && std::abs(poles(a).imag() - poles(b).imag()) < near);
    }
    if (alone) kept.push_back(a);
  }
  return poles(kept);
}

Eigen::VectorXcd without_unusual(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  if (poles.size() == 0) return poles;
  const auto worth = ResidueProblem(data, poles, rigid).residues().significance;
  const double usual = usual_damping(poles, worth);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index m = 0; m < poles.size(); ++m) {
    const double times = -poles(m).real() / (usual * std::abs(poles(m)));
    bool alone = times < Constants::unusual && times * Constants::unusual > 1.0;
    for (Eigen::Index n = 0; n < poles.size(); ++n) {
      const bool near = std::abs(poles(m) - poles(n)) < -poles(m).real();
      alone = alone && !(near && worth(m) < worth(n));
    }
    if (alone) kept.push_back(m);
  }
  return poles(kept);
}

bool is_satellite(const FitData& data, const ModalFit& fit, const std::complex<double>& pole) {
  if (data.noise_stated) return false;
  const double own = std::abs(pole) / (2.0 * pi);
  const double ratio = -pole.real() / std::abs(pole);
  double most = 0.0;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    const double width =
        2.0 * std::max(ratio * own, fit.model.damping_ratio(m) * fit.model.frequency_hz(m));
    if (std::abs(own - fit.model.frequency_hz(m)) < width) return true;
    most = std::max(most, fit.model.damping_ratio(m));
  }
  return ratio > Constants::broad * most;
}

namespace {

// |σ₂ u₂ v₂ᴴ|² of a residue, as a column; empty if it is small beside the first direction.
template <typename Matrix>
Eigen::VectorXd second_direction(const Matrix& residue, const MeasuredResponses& measured) {
  const Eigen::JacobiSVD<Matrix> svd(finite(completed(residue, measured, 1), "residue"),
                                     Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& sigma = svd.singularValues();
  if (sigma.size() < 2 || sigma(1) < Constants::second_direction * sigma(0)) return {};
  const Matrix part = sigma(1) * svd.matrixU().col(1) * svd.matrixV().col(1).adjoint();
  return part.cwiseAbs2().reshaped();
}

}  // namespace

std::vector<Eigen::Index> repeated(const FitData& data, const Eigen::VectorXcd& poles,
                                   const Residues& residues) {
  const double least = least_significance(data, residues.cost);
  const Eigen::ArrayXcd s = std::complex<double>(0.0, 2.0 * pi) * data.frequency_hz.array();
  const auto measured = measured_responses(data.weight, data.outputs);
  std::vector<Eigen::Index> list;
  for (Eigen::Index m = 0; m < poles.size(); ++m) {
    const double width = -2.0 * poles(m).real();
    if (((poles.array() - poles(m)).abs() < width).count() > 1) continue;
    const auto at = static_cast<std::size_t>(m);
    const bool general = !residues.general.empty();
    const Eigen::VectorXd part = general ? second_direction(residues.general[at], measured)
                                         : second_direction(residues.of_pole[at], measured);
    if (part.size() == 0) continue;
    const Eigen::ArrayXcd fraction =
        general ? Eigen::ArrayXcd(s - poles(m)) : s * s + width * s + std::norm(poles(m));
    const Eigen::VectorXd square = fraction.abs2().inverse();
    const Eigen::VectorXd sums = data.weight.cwiseAbs2().transpose() * square;
    if (part.dot(sums) > least) list.push_back(m);
  }
  return list;
}

Eigen::Index rigid_rank(const FitData& data, const Residues& residues, Eigen::Index most) {
  const auto measured = measured_responses(data.weight, data.outputs);
  const double least = least_significance(data, residues.cost);
  const auto highest = std::min({most, data.outputs, data.inputs});
  Eigen::Index rank = 0;
  for (; rank < highest; ++rank) {
    // What the directions before explain of responses that were not measured is no further one.
    const Eigen::MatrixXd term = completed(residues.rigid, measured, rank);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(finite(term, "1/s^2 term"),
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::MatrixXd part =
        svd.singularValues()(rank) * svd.matrixU().col(rank) * svd.matrixV().col(rank).transpose();
    if (part.cwiseAbs2().cwiseProduct(residues.rigid_worth).sum() < least) break;
  }
  return rank;
}

}  // namespace chladni::identification
