#include "priors/learned_corrections.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/finite.h"
#include "priors/constants.h"
#include "priors/gaussian_process/optimum.h"

namespace chladni::priors {
namespace {

constexpr double kImpossible = 1e10;  // stands for minus the logarithm of 0
constexpr double kStep = 1e-4;        // difference step for the slopes, in deviations
constexpr Eigen::Index kEta = 0, kKappa = 1, kGamma = 2, kFirst = 3;

void require_fitting(const std::vector<Correction>& corrections, Eigen::Index r) {
  for (const auto& one : corrections) {
    const auto rows = fmt::to_string(r);
    for (const auto* matrix : {&one.stiffness, &one.mass}) {
      require(matrix->size() == 0 || (matrix->rows() == r && matrix->cols() == r),
              "correction " + one.name + ": its matrices are " + fmt::to_string(matrix->rows()) +
                  "x" + fmt::to_string(matrix->cols()) + ", the simulation has " + rows + " modes");
      require(matrix->allFinite(), "correction " + one.name + ": its matrices are not finite");
    }
    require(one.deviation > 0.0 && std::isfinite(one.deviation),
            "correction " + one.name + ": its deviation must be more than 0");
  }
}

// The unknowns: ln η; then ln κ, ln γ and the corrections in deviations from their prior.
class Search {
 public:
  Search(const MeasuredShapes& measured, const ModalBasis& basis,
         const std::vector<Correction>& corrections, const ResidualErrors& plain,
         const ResidualPlausible& plausible)
      : measured_(measured), basis_(basis), corrections_(corrections), plain_(plain) {
    middle_ = {0.0, std::log(Constants::middle_kappa), std::log(plausible.middle(2))};
    spread_ = {1.0, Constants::kappa_spread, plausible.spread(2)};
    deviation_.resize(static_cast<Eigen::Index>(corrections.size()));
    for (Eigen::Index f = 0; f < deviation_.size(); ++f) {
      deviation_(f) = corrections[static_cast<std::size_t>(f)].deviation;
    }
  }

  [[nodiscard]] Eigen::VectorXd start() const {
    Eigen::VectorXd at = Eigen::VectorXd::Zero(kFirst + deviation_.size());
    at(kEta) = std::log(plain_.prior.eta);
    at(kGamma) = (std::log(plain_.prior.gamma) - middle_(kGamma)) / spread_(kGamma);
    return at;
  }

  [[nodiscard]] ResidualErrors errors(const Eigen::VectorXd& at) const {
    const Eigen::Vector3d value = (middle_ + spread_.cwiseProduct(at.head<3>())).array().exp();
    return {{value(kEta), value(kKappa), value(kGamma)}, plain_.noise};
  }

  [[nodiscard]] Eigen::VectorXd parameters(const Eigen::VectorXd& at) const {
    return deviation_.cwiseProduct(at.tail(deviation_.size()));
  }

  [[nodiscard]] std::optional<CorrectedModes> modes(const Eigen::VectorXd& at) const {
    return corrected_modes(basis_.frequency_hz, corrections_, parameters(at));
  }

  // Minus the logarithm of the posterior density, without a constant.
  double implausibility(const Eigen::VectorXd& at, Eigen::VectorXd& slopes) const {
    const auto found =
        corrected_evidence(measured_, basis_, corrections_, errors(at), parameters(at));
    slopes = at;
    slopes(kEta) = 0.0;
    if (!found) return kImpossible;
    const double value = 0.5 * slopes.squaredNorm() - found->log_evidence;
    slopes.head<3>() -= spread_.cwiseProduct(found->slopes.head<3>());
    slopes.tail(deviation_.size()) -=
        deviation_.cwiseProduct(found->slopes.tail(deviation_.size()));
    return value;
  }

 private:
  const MeasuredShapes& measured_;
  const ModalBasis& basis_;
  const std::vector<Correction>& corrections_;
  ResidualErrors plain_;
  Eigen::Vector3d middle_, spread_;  // of ln η, ln κ, ln γ
  Eigen::VectorXd deviation_;
};

// The lowest point. The search follows it from a large η, with smooth evidence, to a small one.
Optimum lowest(const Search& search) {
  const Objective objective = [&](const Eigen::VectorXd& at, Eigen::VectorXd& slopes) {
    return search.implausibility(at, slopes);
  };
  Eigen::VectorXd at = search.start();
  const double most = at(kEta);
  Eigen::VectorXd upper = Eigen::VectorXd::Constant(at.size(), Constants::farthest_correction);
  Eigen::VectorXd lower = -upper;
  Optimum best;
  int evaluations = 0;
  for (int stage = 0; stage < Constants::correction_stages; ++stage) {
    const bool last = stage + 1 == Constants::correction_stages;
    at(kEta) =
        most + std::log(Constants::least_error_left) * stage / (Constants::correction_stages - 1);
    lower(kEta) = at(kEta);
    upper(kEta) = last ? most : at(kEta);
    best = minimum(objective, at, lower, upper,
                   last ? OptimumOptions{1e-5, 300} : OptimumOptions{1e-2, 40});
    evaluations += best.evaluations;
    at = best.at;
  }
  best.evaluations = evaluations;
  return best;
}

// Root F of the posterior covariance F Fᵀ of γ and the corrections, in units of their prior
// deviations. No direction gets a larger variance than in the prior.
Eigen::MatrixXd posterior_root(const Search& search, const Eigen::VectorXd& at) {
  const Eigen::Index n = at.size() - kGamma;
  Eigen::VectorXd slopes;
  Eigen::VectorXd slopes_beside;
  search.implausibility(at, slopes);
  Eigen::MatrixXd curvature(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::VectorXd moved = at;
    moved(kGamma + k) += kStep;
    search.implausibility(moved, slopes_beside);
    curvature.col(k) = (slopes_beside - slopes).tail(n) / kStep;
  }
  const Eigen::MatrixXd symmetric = 0.5 * (curvature + curvature.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(symmetric, "corrections: curvature of the posterior"));
  if (solver.info() != Eigen::Success) {
    throw NumericalFailure("corrections: the posterior has no finite curvature");
  }
  return solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(1.0).cwiseSqrt().cwiseInverse().asDiagonal();
}

std::vector<CorrectedSimulation> simulations_aside(const Search& search, const Eigen::VectorXd& at,
                                                   const Eigen::MatrixXd& root) {
  std::vector<CorrectedSimulation> aside;
  for (Eigen::Index k = 0; k < root.cols(); ++k) {
    for (const double side : {1.0, -1.0}) {  // one side may have no positive mass
      Eigen::VectorXd moved = at;
      moved.tail(root.rows()) += side * root.col(k);
      auto modes = search.modes(moved);
      if (!modes) continue;
      aside.push_back({std::move(*modes), search.errors(moved)});
      break;
    }
  }
  return aside;
}

// What is far from plausible although the simulation is corrected. κ is not learned, and η has no
// prior here: corrections are to make it small, so only a large one is doubted.
std::vector<std::string> doubts_left(ResidualErrors errors, const ResidualPlausible& plausible) {
  errors.prior.kappa = plausible.middle(kKappa);
  errors.prior.eta = std::max(errors.prior.eta, plausible.middle(kEta));
  return doubts_of(errors, plausible);
}

}  // namespace

LearnedCorrections learned_corrections(const MeasuredShapes& measured, const ModalBasis& basis,
                                       const std::vector<Correction>& corrections,
                                       const ResidualPlausible& plausible) {
  require_fitting(corrections, basis.frequency_hz.size());
  const auto plain = learned_errors(measured, basis, plausible);
  const Search search(measured, basis, corrections, plain.errors, plausible);
  const auto best = lowest(search);
  LearnedCorrections learned;
  learned.evaluations = best.evaluations + plain.evaluations;
  learned.parameters = search.parameters(best.at);
  learned.likeliest = {search.modes(best.at).value(), search.errors(best.at)};
  const auto root = posterior_root(search, best.at);
  learned.aside = simulations_aside(search, best.at, root);
  learned.log_evidence = 0.5 * best.at.tail(best.at.size() - 1).squaredNorm() - best.value;
  learned.doubts = doubts_left(learned.likeliest.errors, plausible);
  learned.deviation.resize(learned.parameters.size());
  for (Eigen::Index f = 0; f < learned.parameters.size(); ++f) {
    const auto& correction = corrections[static_cast<std::size_t>(f)];
    learned.deviation(f) = correction.deviation * root.row(1 + f).norm();
    const double away = std::abs(best.at(kFirst + f));
    if (away < Constants::doubtful) continue;
    learned.correction_doubts.push_back(
        fmt::format("correction {} is {:.3g}, {:.1f} of the deviations that were thought plausible",
                    correction.name, learned.parameters(f), away));
  }
  return learned;
}

}  // namespace chladni::priors
