#include "diagnosis/modes/modes_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/calibration.h"
#include "diagnosis/modes/calibration/coordinates.h"
#include "diagnosis/modes/cause_modes.h"
#include "diagnosis/modes/errors/covariance_slopes.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kLevelRounds = 4;  // of levels alone, at the end
constexpr int kAttempts = 5;     // at a step that lowers the objective
constexpr int kDoubled = 3;      // times that such a step is made longer

// One hypothesis on its way to its most probable sizes.
class Descent {
 public:
  Descent(const ModesProblem& problem, ModesFit start)
      : problem_(problem),
        fit_(std::move(start)),
        all_(supposed(problem.constants(), fit_.constants, fit_.causes)),
        prior_(prior_of(problem.structure(), problem.constants(), all_)),
        modes_(problem) {}

  enum class Pairs { probable, given };  // given: those of the start

  // False: the start is impossible.
  bool begin(Pairs pairs) {
    auto model = modes_.of(all_);
    if (!model || !std::isfinite(log_prior_of(all_))) return false;
    fit_.model = std::move(*model);
    fit_.objective = kInfinite;
    const auto given = fit_.matching.model;
    if (pairs == Pairs::probable) pair_again();
    if (!given.empty()) pair_as(matching_of(problem_.measured(), fit_.model, given));
    return std::isfinite(fit_.objective);
  }

  void round() {
    if (prior_.centre.size() > 0) step();
    learn();
  }

  void learn() {
    if (problem_.prior().width <= 0.0) return;
    fit_.levels = updated(fit_.levels, problem_.prior(), evidence());
    take({likelihood_->errors(), fit_.levels});
  }

  // Levels alone, beside sizes that stay where they are.
  void settle(int rounds) {
    if (prior_.centre.size() > 0) slope_ = slopes(Of::errors).errors;
    for (int round = 0; round < rounds; ++round) learn();
  }

  // Pairs the modes in the most probable way.
  void pair_again() {
    for (const auto& matching : problem_.matchings(fit_.model)) pair_as(matching);
  }

  // The partners without that of the mode that belongs least to the others; empty where all do. One
  // mode at most is without the partner that it could have, in every hypothesis that is fitted in
  // full; a quick fit pairs all.
  // Where levels are known, what deviates more is what a cause has to explain.
  [[nodiscard]] std::vector<Index> partners_without_worst() const {
    if (fit_.disturbed.what == Disturbed::What::mode || problem_.prior().width <= 0.0) return {};
    if (count_alone(fit_.matching) > count_alone(problem_.matchings(fit_.model).front())) return {};
    VectorXd excess = likelihood_->block_squares();
    const auto& blocks = likelihood_->errors().blocks;
    for (Index b = 0; b < excess.size(); ++b) {
      excess(b) -= static_cast<double>(blocks[at(b)].count());
      if (fit_.matching.model[at(b)] < 0) excess(b) = 0.0;
    }
    Index worst = 0;
    if (!(excess.maxCoeff(&worst) > 2.0 * kConstants.alone)) return {};
    auto partners = fit_.matching.model;
    partners[at(worst)] = -1;
    return partners;
  }

  // After `settle`.
  [[nodiscard]] ModesFit taken() {
    const auto known = evidence();
    fit_.determined = known.determined;
    const double levels = negative_log_prior(fit_.levels, problem_.prior(), known);
    const MatrixXd hessian = prior_.centre.size() > 0 ? curvature(slope_) : MatrixXd();
    const Index n = hessian.rows();
    double volume = 0.0;
    if (n > 0) {
      const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(hessian);
      const VectorXd precision = parts.eigenvalues().cwiseMax(1e-300);
      volume = 0.5 * (static_cast<double>(n) * std::log(2.0 * std::numbers::pi) -
                      precision.array().log().sum());
      fit_.covariance = causes_first(parts.eigenvectors() * precision.cwiseInverse().asDiagonal() *
                                     parts.eigenvectors().transpose());
    }
    fit_.log_evidence = volume - levels - fit_.objective;
    return std::move(fit_);
  }

  // −ln of the density of the errors at the present levels, whatever the sizes are.
  [[nodiscard]] double value() const {
    if (slope_.rows() != own_.size() || slope_.cols() == 0) return fit_.objective;
    const MatrixXd lower = curvature(slope_).llt().matrixL();
    return fit_.objective + lower.diagonal().array().log().sum();
  }

 private:
  // If these pairs are more probable.
  void pair_as(const Matching& matching) {
    if (likelihood_ && matching.model == fit_.matching.model) return;
    LevelLikelihood other(problem_.errors(fit_, fit_.model, matching), fit_.levels);
    if (!(other.negative_log() - log_prior_of(all_) < fit_.objective)) return;
    fit_.matching = matching;
    slope_.resize(0, 0);
    take(std::move(other));
  }
  [[nodiscard]] Index held() const { return static_cast<Index>(problem_.constants().size()); }
  [[nodiscard]] double log_prior_of(const std::vector<Supposed>& all) const {
    return log_prior(problem_.structure(), problem_.constants(), all);
  }
  void put_back() {
    fit_.constants = coordinates(all_).head(held());
    fit_.causes.assign(all_.begin() + held(), all_.end());
  }
  // A covariance in the order that a ModesFit has.
  [[nodiscard]] MatrixXd causes_first(const MatrixXd& covariance) const {
    std::vector<Index> order;
    for (Index i = 0; i < covariance.rows(); ++i) order.push_back((i + held()) % covariance.rows());
    return covariance(order, order);
  }

  // The likelihood at the present causes and levels.
  void take(LevelLikelihood likelihood) {
    likelihood_ = std::move(likelihood);
    own_ = stacked(likelihood_->errors());
    fit_.objective = likelihood_->negative_log() - log_prior_of(all_);
  }

  // What the data say of the levels, whatever the sizes are: sizes that fit the errors take as many
  // of them away as they have coordinates. To first order they are errors that all modes share.
  [[nodiscard]] LevelLikelihood::Evidence evidence() const {
    if (slope_.rows() != own_.size() || slope_.cols() == 0) return likelihood_->evidence();
    auto errors = with_sizes(likelihood_->errors(), slope_, prior_, coordinates(all_));
    return LevelLikelihood(std::move(errors), fit_.levels).evidence();
  }

  // Errors at other sizes with the present pairs; none where the numbers are not the same ones.
  [[nodiscard]] std::optional<ModeErrors> errors_at(const RecordedModes& model,
                                                    bool with_shared) const {
    if (model.count() != fit_.model.count()) return std::nullopt;
    auto there = problem_.errors(fit_, model, fit_.matching, with_shared);
    if (numbers(there) != own_.size()) return std::nullopt;
    return there;
  }
  [[nodiscard]] std::optional<LevelLikelihood> likelihood_of(ModeErrors errors) const {
    try {
      return LevelLikelihood(std::move(errors), fit_.levels);
    } catch (const NumericalFailure&) {
      return std::nullopt;  // sizes at which a covariance is none
    }
  }

  // Slopes in x with the present pairs: of the errors (measured less model), and of the likelihood,
  // whose covariance changes with x too. The number of modes that nothing was measured of jumps,
  // and is left out.
  enum class Of { errors, both };
  struct Slopes {
    MatrixXd errors;
    VectorXd likelihood;
    MatrixXd information;  // of the covariance; 0 where its slopes are not asked for
  };
  [[nodiscard]] Slopes slopes(Of what) {
    modes_.begin_at(all_);
    const Index n = prior_.centre.size();
    Slopes result{MatrixXd::Zero(own_.size(), n), VectorXd::Zero(n), {}};
    std::optional<CovarianceSlopes> covariance;
    if (what == Of::both) covariance.emplace(likelihood_->errors(), fit_.levels);
    MatrixXd changes = MatrixXd::Zero(covariance ? covariance->count() : 0, n);
    const double here = likelihood_->negative_log() - likelihood_->errors().penalty;
    for (Index c = 0; c < n; ++c) {
      VectorXd step = VectorXd::Zero(n);
      for (const double sign : {1.0, -1.0}) {
        step(c) = sign * prior_.step(c);
        const auto model = modes_.with_coordinate(moved(all_, step), c);
        if (!model) continue;
        auto there = errors_at(*model, what == Of::both);
        if (!there) continue;
        result.errors.col(c) = (stacked(*there) - own_) / step(c);
        if (what == Of::errors) break;
        const double penalty = there->penalty;
        changes.col(c) = covariance->of(*there, step(c));
        const auto other = likelihood_of(std::move(*there));
        if (other) result.likelihood(c) = (other->negative_log() - penalty - here) / step(c);
        break;
      }
    }
    result.information = 0.5 * changes.transpose() * changes;
    return result;
  }

  // The second derivative of the objective in x, with a positive diagonal.
  [[nodiscard]] MatrixXd curvature(const MatrixXd& slope) const {
    MatrixXd hessian = likelihood_->product(slope, slope);
    hessian.diagonal() += prior_.precision;
    hessian.diagonal() = hessian.diagonal().cwiseMax(1e-12);
    return hessian;
  }

  // Where a step leads.
  struct Arrival {
    std::vector<Supposed> all;
    RecordedModes model;
    Matching matching;
    bool is_alike = false;  // as many modes, and as many numbers of each
    LevelLikelihood likelihood;
    double objective = 0.0;
  };

  // Two directions: of the objective, and of the misfit alone at the present covariance. Near a
  // mode that a cause splits in two the covariance changes at once, and hides the way to its sizes.
  void step() {
    const auto slope = slopes(Of::both);
    slope_ = slope.errors;
    const MatrixXd of_misfit = curvature(slope_);
    const MatrixXd of_all = of_misfit + slope.information;
    const VectorXd prior = prior_.slope(coordinates(all_));
    const VectorXd all = slope.likelihood + prior;
    const VectorXd misfit = likelihood_->product(slope_, own_) + prior;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      auto there = better(damped_step(of_all, all), damped_step(of_misfit, misfit));
      if (there && there->arrival.objective < fit_.objective) {
        take(farther(there->by, std::move(there->arrival)));
        damping_ *= 0.2;
        return;
      }
      damping_ = 8.0 * damping_ + 0.05;
    }
  }

  struct Step {
    VectorXd by;
    Arrival arrival;
  };
  [[nodiscard]] std::optional<Step> damped_step(MatrixXd hessian, const VectorXd& slope) const {
    hessian.diagonal() *= 1.0 + damping_;
    VectorXd by = -Eigen::LDLT<MatrixXd>(hessian).solve(slope);
    auto there = arrival_at(by);
    if (!there) return std::nullopt;
    return Step{std::move(by), std::move(*there)};
  }
  static std::optional<Step> better(std::optional<Step> one, std::optional<Step> other) {
    const bool is_other = other && !(one && one->arrival.objective <= other->arrival.objective);
    return is_other ? std::move(other) : std::move(one);
  }

  // The best of the arrivals at `by`, twice and more as far: valleys are flatter than the
  // information that is expected.
  [[nodiscard]] Arrival farther(VectorXd by, Arrival best) const {
    for (int doubled = 0; doubled < kDoubled; ++doubled) {
      by *= 2.0;
      auto next = arrival_at(by);
      if (!next || !(next->objective < best.objective)) break;
      best = std::move(*next);
    }
    return best;
  }

  [[nodiscard]] std::optional<Arrival> arrival_at(const VectorXd& by) const {
    if (!by.allFinite()) return std::nullopt;
    auto all = moved(all_, by);
    for (std::size_t c = 0; c < all.size(); ++c) {
      keep_on_surface(problem_.structure(), all_[c], all[c]);
    }
    const double prior = log_prior_of(all);
    if (!std::isfinite(prior)) return std::nullopt;
    auto model = modes_.of(all);
    if (!model) return std::nullopt;
    auto matching = fit_.matching;
    auto errors = errors_at(*model, true);
    const bool is_alike = errors.has_value();
    if (!is_alike) {
      matching = problem_.matchings(*model).front();
      // Where levels are known a mode without a partner may cost less than one with a bad one.
      const bool is_lost = count_alone(matching) > count_alone(fit_.matching);
      if (problem_.prior().width <= 0.0 && is_lost) return std::nullopt;
      errors = problem_.errors(fit_, *model, matching);
    }
    auto likelihood = likelihood_of(std::move(*errors));
    if (!likelihood) return std::nullopt;
    const double objective = likelihood->negative_log() - prior;
    if (!std::isfinite(objective)) return std::nullopt;
    return Arrival{std::move(all), std::move(*model),      std::move(matching),
                   is_alike,       std::move(*likelihood), objective};
  }

  void take(Arrival arrival) {
    if (!arrival.is_alike) slope_.resize(0, 0);
    fit_.matching = std::move(arrival.matching);
    all_ = std::move(arrival.all);
    put_back();
    fit_.model = std::move(arrival.model);
    take(std::move(arrival.likelihood));
  }

  const ModesProblem& problem_;
  ModesFit fit_;
  std::vector<Supposed> all_;  // constants and causes
  CoordinatePrior prior_;
  std::optional<LevelLikelihood> likelihood_;
  CauseModes modes_;
  VectorXd own_;    // errors at the present sizes
  MatrixXd slope_;  // of the errors in the coordinates, about there; empty: not known
  double damping_ = 1e-3;
};

// Rounds until one gains little, then the levels alone.
void descend(Descent& descent, int rounds, bool pairs_again) {
  double before = kInfinite;
  for (int round = 0; round < rounds; ++round) {
    descent.round();
    if (pairs_again) descent.pair_again();
    if (round > 1 && before - descent.value() < kConstants.enough_fall) break;
    before = descent.value();
  }
  descent.settle(std::min(rounds, kLevelRounds));
}

// The fit with the partners of the start, unless a step changes the number of modes.
std::optional<ModesFit> fitted_as_paired(const ModesProblem& problem, const ModesFit& start) {
  Descent descent(problem, start);
  if (!descent.begin(Descent::Pairs::given)) return std::nullopt;
  descend(descent, ModesProblem::kRounds, false);
  return descent.taken();
}

}  // namespace

ModesFit ModesProblem::fitted(const ModesFit& start, int rounds) const {
  ModesFit first = start;
  if (!(first.levels > 0.0).any()) first.levels = prior_.usual;
  if (first.constants.size() == 0) {
    first.constants = VectorXd::Zero(static_cast<Index>(constants_.size()));
  }
  Descent descent(*this, first);
  first.log_evidence = -kInfinite;  // where no body is like this, whatever the start was worth
  if (!descent.begin(Descent::Pairs::probable)) return first;
  descend(descent, rounds, true);
  auto fewer = rounds == kRounds ? descent.partners_without_worst() : std::vector<Index>();
  ModesFit fit = descent.taken();
  if (fewer.empty()) return fit;
  // The likest pair may still be a wrong one, which costs a hypothesis more than none.
  ModesFit apart = fit;
  apart.matching.model = std::move(fewer);
  auto other = fitted_as_paired(*this, apart);
  return other && other->log_evidence > fit.log_evidence ? std::move(*other) : fit;
}

ModesFit ModesProblem::nothing(const Disturbed& disturbed) const {
  ModesFit start;
  start.disturbed = disturbed;
  auto fit = constants_.empty() ? fitted(start) : calibrated(*this, start);
  if (fit.matching.model.empty()) {
    const auto& hz = measured_.frequency_hz;
    throw InvalidInput(fmt::format(
        "the measured modes, {:.5g} to {:.5g} Hz, are far from all simulated ones, up to {:.5g} "
        "Hz; expected frequencies in Hz of this structure",
        hz.minCoeff(), hz.maxCoeff(), structure_.frequency_hz.maxCoeff()));
  }
  return fit;
}

}  // namespace chladni::diagnosis
