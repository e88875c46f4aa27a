#include "diagnosis/modes/modes_look.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/coordinates.h"

namespace chladni::diagnosis {

using Eigen::Index;

std::vector<PerClass> levels_to_look_at(const ModesProblem& problem, const ModesFit& base) {
  std::vector<PerClass> all{base.levels};
  if (problem.prior().width <= 0.0) return all;
  for (const double times : {kConstants.scattered, kConstants.scattered * kConstants.scattered}) {
    PerClass other = base.levels;
    for (const auto of : {ErrorClass::frequency, ErrorClass::gain, ErrorClass::place}) {
      const auto i = static_cast<Index>(of);
      other(i) = std::max(other(i) / times, problem.prior().usual(i));
    }
    other = other.min(base.levels);
    if ((other < all.back()).any()) all.push_back(other);
  }
  return all;
}

ModesLook::ModesLook(const ModesProblem& problem, const ModesFit& base,
                     std::vector<PerClass> levels)
    : problem_(problem),
      base_(base),
      levels_(std::move(levels)),
      columns_(problem, base),
      state_(problem.with(base)) {
  const auto errors = columns_.added(problem.errors(base, base.model, base.matching));
  for (const auto& one : levels_) likelihoods_.emplace_back(errors, one);
  own_ = stacked(errors);
  const auto model = problem.modes(state_, true);
  if (!model) return;
  quick_hz_ = model->frequency_hz;
  const auto matchings = problem.matchings(*model);
  pairs_may_be_wrong_ = matchings.size() > 1;
  quick_matching_ = matchings.front();
  for (const auto& matching : matchings) {
    if (matching.model == base.matching.model) quick_matching_ = matching;
  }
  here_ = shifted(*model, quick_matching_);
}

std::vector<double> ModesLook::operator()(const Supposed& cause) const {
  std::vector<double> least(levels_.size(), HUGE_VAL);
  const double prior = log_prior(cause, problem_.structure());
  if (!std::isfinite(prior)) return least;
  const auto model = with(cause);
  if (!model) return least;
  const auto take = [&](const Matching& matching) {
    const auto there = objectives(*model, matching);
    for (std::size_t i = 0; i < least.size(); ++i) {
      least[i] = std::min(least[i], there[i] - prior);
    }
  };
  if (model->frequency_hz.size() == quick_hz_.size() && model->frequency_hz == quick_hz_) {
    take(quick_matching_);
    if (least.front() == HUGE_VAL || !pairs_may_be_wrong_) return least;
  }
  for (const auto& matching : problem_.matchings(*model)) take(matching);
  return least;
}

struct ModesLook::Placed {
  Supposed cause;
  RecordedModes model;
  Matching matching;
  LevelLikelihood likelihood;
  double objective = 0.0;
};

std::optional<ModesLook::Placed> ModesLook::placed(const Supposed& cause, std::size_t level) const {
  const double prior = log_prior(cause, problem_.structure());
  if (!std::isfinite(prior)) return std::nullopt;
  auto model = with(cause);
  if (!model) return std::nullopt;
  std::optional<Placed> best;
  for (const auto& matching : problem_.matchings(*model)) {
    LevelLikelihood likelihood(columns_.added(problem_.errors(base_, *model, matching)),
                               levels_[level]);
    const double objective = likelihood.negative_log() - prior;
    if (best && !(objective < best->objective)) continue;
    best = Placed{cause, *model, matching, std::move(likelihood), objective};
  }
  return best;
}

// d(measured less model)/dx with these pairs; 0 where a mode comes or goes.
Eigen::MatrixXd ModesLook::slopes(const Placed& at, const Eigen::VectorXd& steps) const {
  const Eigen::VectorXd here = shifted(at.model, at.matching);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(here.size(), steps.size());
  for (Index c = 0; c < steps.size(); ++c) {
    for (const double sign : {1.0, -1.0}) {
      Supposed cause = at.cause;
      cause.x(c) += sign * steps(c);
      const auto model = with(cause);
      if (!model || model->count() != at.model.count()) continue;
      const Eigen::VectorXd there = shifted(*model, at.matching);
      if (there.size() != here.size()) continue;
      all.col(c) = (there - here) / (sign * steps(c));
      break;
    }
  }
  return all;
}

ModesLook::Moved ModesLook::moved(const Supposed& cause, std::size_t level) const {
  auto now = placed(cause, level);
  if (!now) return {cause, HUGE_VAL};
  const auto prior = prior_of(problem_.structure(), {}, {cause});
  for (int round = 0; round < 4 && cause.x.size() > 0; ++round) {
    const Eigen::MatrixXd slope = slopes(*now, prior.step);
    const Eigen::VectorXd error = stacked(now->likelihood.errors());
    Eigen::MatrixXd hessian = now->likelihood.product(slope, slope);
    hessian.diagonal() += prior.precision;
    const Eigen::VectorXd by = -hessian.ldlt().solve(
        Eigen::VectorXd(now->likelihood.product(slope, error) + prior.slope(now->cause.x)));
    if (!by.allFinite()) break;
    const double before = now->objective;
    for (const double part : {1.0, 0.3}) {
      Supposed next = now->cause;
      next.x += part * by;
      keep_on_surface(problem_.structure(), now->cause, next);
      auto there = placed(next, level);
      if (!there || !(there->objective < before)) continue;
      now = std::move(there);
      break;
    }
    if (before - now->objective < kConstants.start_fall) break;
  }
  return {now->cause, now->objective};
}

// −ln likelihoods; infinite where no number changes.
std::vector<double> ModesLook::objectives(const RecordedModes& model,
                                          const Matching& matching) const {
  std::vector<double> all(levels_.size(), HUGE_VAL);
  if (same_partners(matching)) {
    const Eigen::VectorXd there = shifted(model, matching);
    if (there.size() == here_.size()) {
      const Eigen::VectorXd change = there - here_;
      if (change.cwiseAbs().maxCoeff() < kConstants.unchanged) return all;
      for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = likelihoods_[i].negative_log(own_ + change);
      }
      return all;
    }
  }
  const auto errors = columns_.added(problem_.errors(base_, model, matching));
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = LevelLikelihood(errors, levels_[i]).negative_log();
  }
  return all;
}

Eigen::VectorXd ModesLook::shifted(const RecordedModes& model, const Matching& matching) const {
  return stacked(problem_.errors(base_, model, matching, false));
}

bool ModesLook::same_partners(const Matching& matching) const {
  for (std::size_t i = 0; i < matching.model.size(); ++i) {
    if ((matching.model[i] < 0) != (base_.matching.model[i] < 0)) return false;
  }
  return true;
}

std::optional<RecordedModes> ModesLook::with(const Supposed& cause) const {
  try {
    State state = state_;
    cause.effect->apply(state, problem_.structure(), cause.option, cause.x);
    return problem_.modes(state, true);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace chladni::diagnosis
