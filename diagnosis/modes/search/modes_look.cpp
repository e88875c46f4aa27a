#include "diagnosis/modes/search/modes_look.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/calibration/coordinates.h"

namespace chladni::diagnosis {

using Eigen::Index;

namespace {

// Classes that one cause raises together.
const std::vector<std::vector<ErrorClass>>& raised_together() {
  using enum ErrorClass;
  static const std::vector<std::vector<ErrorClass>> groups{
      {frequency}, {gain, place}, {shape, smooth_shape}, {residue}, {field}};
  return groups;
}

// −ln of the prior density of the levels, less that of others.
double less_probable(const PerClass& levels, const PerClass& than, const LevelPrior& prior) {
  if (prior.width <= 0.0) return 0.0;
  const auto square = [&](const PerClass& of) { return (of / prior.usual).log().square().sum(); };
  return 0.5 * (square(levels) - square(than)) / (prior.width * prior.width);
}

}  // namespace

std::vector<PerClass> levels_to_look_at(const ModesProblem& problem, const ModesFit& base) {
  std::vector<PerClass> all{base.levels};
  const auto& prior = problem.prior();
  if (prior.width <= 0.0) return all;
  for (const auto& group : raised_together()) {
    PerClass last = base.levels;
    for (const double times : {kConstants.scattered, kConstants.scattered * kConstants.scattered}) {
      PerClass other = base.levels;
      for (const auto of : group) {
        const auto i = static_cast<Index>(of);
        other(i) = std::min(base.levels(i), std::max(base.levels(i) / times, prior.usual(i)));
      }
      if (!(other < kConstants.levels_alike * last).any()) continue;
      all.push_back(other);
      last = other;
    }
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
  own_ = stacked(errors);
  for (const auto& one : levels_) {
    likelihoods_.emplace_back(errors, one);
    less_probable_.push_back(less_probable(one, base.levels, problem.prior()));
  }
  body_ = problem.body_modes(state_, true);
  const auto model = body_ ? ModesProblem::modes(state_, *body_) : std::nullopt;
  if (!model) return;
  quick_ = *model;
  const auto matchings = this->matchings(*model);
  for (const auto& matching : matchings) {
    without_cause_.emplace_back(matching.model, shifted(*model, matching));
  }
  pairs_may_be_wrong_ = matchings.size() > 1 || count_alone(base.matching) > 0;
  quick_matching_ = matchings.front();
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
      least[i] = std::min(least[i], there[i] - prior + less_probable_[i]);
    }
  };
  if (has_quick_pairs(*model)) {
    take(quick_matching_);
    if (least.front() == HUGE_VAL || !pairs_may_be_wrong_) return least;
  }
  for (const auto& matching : matchings(*model)) take(matching);
  return least;
}

// Whether frequencies and labels are those without the cause: exchanged records pair anew.
bool ModesLook::has_quick_pairs(const RecordedModes& model) const {
  return model.frequency_hz.size() == quick_.frequency_hz.size() &&
         model.frequency_hz == quick_.frequency_hz && model.output_of == quick_.output_of &&
         model.input_of == quick_.input_of;
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
  for (const auto& matching : matchings(*model)) {
    LevelLikelihood likelihood(columns_.added(problem_.errors(base_, *model, matching)),
                               levels_[level]);
    const double objective = likelihood.negative_log() - prior + less_probable_[level];
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
  if (!now) return {cause, -HUGE_VAL};
  const auto prior = prior_of(problem_.structure(), {}, {cause});
  double volume = 0.0;
  for (int round = 0; round < 4 && cause.x.size() > 0; ++round) {
    const Eigen::MatrixXd slope = slopes(*now, prior.step);
    const Eigen::VectorXd error = stacked(now->likelihood.errors());
    Eigen::MatrixXd hessian = now->likelihood.product(slope, slope);
    hessian.diagonal() += prior.precision;
    const Eigen::LDLT<Eigen::MatrixXd> factor(hessian);
    volume =
        0.5 * (static_cast<double>(slope.cols()) * std::log(2.0 * std::numbers::pi) -
               factor.vectorD().array().max(std::numeric_limits<double>::epsilon()).log().sum());
    const Eigen::VectorXd by = -factor.solve(
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
  return {now->cause, volume - now->objective};
}

// −ln likelihoods; infinite where no number changes.
std::vector<double> ModesLook::objectives(const RecordedModes& model,
                                          const Matching& matching) const {
  const auto kept = alike_blocks(matching);
  const bool all_kept = std::ranges::find(kept, false) == kept.end();
  if (all_kept && here_.size() > 0) return objectives_alike(model, matching);
  auto others = kept;
  others.flip();
  const auto errors = columns_.added(problem_.errors(base_, model, matching, others));
  std::vector<double> all;
  for (const auto& likelihood : likelihoods_) all.push_back(likelihood.negative_log(errors, kept));
  return all;
}

// The same where each block has the covariance of the base.
std::vector<double> ModesLook::objectives_alike(const RecordedModes& model,
                                                const Matching& matching) const {
  std::vector<double> all(levels_.size(), HUGE_VAL);
  const Eigen::VectorXd there = shifted(model, matching);
  const Eigen::VectorXd change = there - here_;
  if (change.cwiseAbs().maxCoeff() < kConstants.unchanged) return all;
  const auto* own = without_cause(matching, there.size());
  Eigen::MatrixXd columns(there.size(), own ? 2 : 1);
  columns.col(0) = own_ + change;
  if (own) columns.col(1) = there - *own;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::VectorXd squares = likelihoods_[i].squares(columns);
    if (own && squares(1) < kConstants.start_seen) continue;
    all[i] = likelihoods_[i].negative_log(squares(0));
  }
  return all;
}

// Whether each mode has a partner or none, as in the base, and so as many numbers.
std::vector<bool> ModesLook::alike_blocks(const Matching& matching) const {
  std::vector<bool> alike;
  for (std::size_t i = 0; i < matching.model.size(); ++i) {
    alike.push_back((matching.model[i] < 0) == (base_.matching.model[i] < 0));
  }
  return alike;
}

Eigen::VectorXd ModesLook::shifted(const RecordedModes& model, const Matching& matching) const {
  return stacked(problem_.errors(base_, model, matching, false));
}

// The pairs of the base first, then those of the problem.
std::vector<Matching> ModesLook::matchings(const RecordedModes& model) const {
  std::vector<Matching> all{matching_of(problem_.measured(), model, base_.matching.model)};
  if (all.front().model != base_.matching.model) all.clear();
  for (auto& matching : problem_.matchings(model)) {
    const bool is_known = std::ranges::any_of(
        all, [&](const Matching& other) { return other.model == matching.model; });
    if (!is_known) all.push_back(std::move(matching));
  }
  return all;
}

// The errors of the base with the same pairs; none if it cannot have them.
const Eigen::VectorXd* ModesLook::without_cause(const Matching& matching, Index count) const {
  for (const auto& [partners, errors] : without_cause_) {
    if (partners == matching.model && errors.size() == count) return &errors;
  }
  return nullptr;
}

std::optional<RecordedModes> ModesLook::with(const Supposed& cause) const {
  try {
    State state = state_;
    cause.effect->apply(state, problem_.structure(), cause.option, cause.x);
    const bool is_known = body_ && have_same_body(state, state_);
    return is_known ? ModesProblem::modes(state, *body_) : problem_.modes(state, true);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace chladni::diagnosis
