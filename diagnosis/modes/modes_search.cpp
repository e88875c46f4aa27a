#include "diagnosis/modes/modes_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/modes_look.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kPerEffect = 3;  // starts of one effect that are fitted in full, at most
constexpr std::size_t kMoved = 3;      // starts of one effect, and of other sizes, that are moved
constexpr std::size_t kLookedAt = 24;  // starts that are fitted in two rounds, per level
constexpr std::size_t kInFull = 8;     // of these, fitted in full
constexpr int kQuickRounds = 2;        // of such a first fit
constexpr std::size_t kBeam = 2;       // fits from which a further cause is sought

struct Candidate {
  Supposed cause;
  PerClass levels = PerClass::Zero();
  double objective = 0.0;  // after a move −ln evidence
};

// The best of them, each of another choice or place.
std::vector<Candidate> first_of(const ModesProblem& problem, std::vector<Candidate> all,
                                std::size_t most) {
  std::ranges::stable_sort(all, {}, &Candidate::objective);
  std::vector<Candidate> best;
  for (auto& candidate : all) {
    if (best.size() == most) break;
    const bool is_new = std::ranges::none_of(best, [&](const Candidate& other) {
      return alike(problem.structure(), candidate.cause, other.cause);
    });
    if (is_new) best.push_back(std::move(candidate));
  }
  return best;
}

// The coordinates of a cause without its place.
Eigen::VectorXd coordinates_without_place(const ModesProblem& problem, const Supposed& cause) {
  Eigen::VectorXd x = cause.x;
  const auto parameters = cause.effect->parameters(problem.structure());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].is_place()) x(static_cast<Index>(i)) = 0.0;
  }
  return x;
}

// The starts of one effect that are moved at a choice of levels: the best at places and choices of
// their own, and the best of other sizes. On a coarse grid a small size often looks better than one
// near the truth at a place nearby, and does not lead there.
std::vector<Candidate> to_move(const ModesProblem& problem, std::vector<Candidate> all,
                               std::size_t places, std::size_t sizes) {
  auto some = first_of(problem, all, places);
  const std::size_t most = some.size() + sizes;
  std::ranges::stable_sort(all, {}, &Candidate::objective);
  for (const auto& candidate : all) {
    if (some.size() == most) break;
    const auto x = coordinates_without_place(problem, candidate.cause);
    const bool is_new = std::ranges::none_of(some, [&](const Candidate& other) {
      return coordinates_without_place(problem, other.cause) == x;
    });
    if (is_new) some.push_back(candidate);
  }
  return some;
}

// The best starts of one effect, at places and choices of their own. The best of the grid at each
// of the levels are moved first: neighbours on it may differ by more than the errors are.
std::vector<Candidate> best_of(const ModesLook& look, const ModesProblem& problem,
                               const Effect& effect) {
  const auto& hz = problem.measured().frequency_hz;
  const auto& levels = look.levels();
  std::vector<std::vector<Candidate>> at_level(levels.size());
  for (const auto& start : grid_of(problem.structure(), effect, hz.minCoeff(), hz.maxCoeff())) {
    const auto objectives = look(start);
    for (std::size_t i = 0; i < objectives.size(); ++i) {
      if (std::isfinite(objectives[i])) {
        at_level[i].push_back({start, levels[i], objectives[i]});
      }
    }
  }
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::size_t most = i == 0 ? kMoved : 1;
    for (auto& one : to_move(problem, std::move(at_level[i]), most, most)) {
      auto moved = look.moved(one.cause, i);
      if (!std::isfinite(moved.log_evidence)) continue;
      all.push_back({std::move(moved.cause), levels[i], -moved.log_evidence});
    }
  }
  return first_of(problem, std::move(all), kPerEffect);
}

// The best starts of all effects; each effect keeps its best one.
std::vector<Candidate> candidates(const ModesProblem& problem, const ModesFit& base,
                                  const std::vector<const Effect*>& catalogue, double& effects) {
  const ModesLook look(problem, base, levels_to_look_at(problem, base));
  std::vector<std::vector<Candidate>> best(catalogue.size());
  parallel_tasks(catalogue.size(),
                 [&](std::size_t e) { best[e] = best_of(look, problem, *catalogue[e]); });
  std::vector<Candidate> first, more;
  for (auto& of_effect : best) {
    for (std::size_t i = 0; i < of_effect.size(); ++i) {
      (i == 0 ? first : more).push_back(std::move(of_effect[i]));
    }
  }
  effects = static_cast<double>(first.size());
  const auto keep = [](std::vector<Candidate>& all, std::size_t most) {
    std::ranges::stable_sort(all, {}, &Candidate::objective);
    if (all.size() > most) all.resize(most);
  };
  keep(first, 2 * kLookedAt / 3);
  keep(more, kLookedAt / 3);
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

void sort(std::vector<ModesFit>& fits) {
  std::ranges::stable_sort(fits, std::ranges::greater{}, &ModesFit::log_evidence);
}

// All starts in two rounds, then the best of them in full.
std::vector<ModesFit> fitted_with(const ModesProblem& problem, const ModesFit& base,
                                  const std::vector<Candidate>& starts) {
  std::vector<ModesFit> fits(starts.size());
  parallel_tasks(starts.size(), [&](std::size_t i) {
    ModesFit start = base;
    start.causes.push_back(starts[i].cause);
    start.levels = starts[i].levels;
    fits[i] = problem.fitted(start, kQuickRounds);
  });
  sort(fits);
  if (fits.size() > kInFull) fits.resize(kInFull);
  parallel_tasks(fits.size(), [&](std::size_t i) { fits[i] = problem.fitted(fits[i]); });
  std::erase_if(fits, [](const ModesFit& fit) { return !std::isfinite(fit.log_evidence); });
  return fits;
}

// A mode or a channel that is not believed, each in turn.
std::vector<ModesFit> disturbed_fits(const ModesProblem& problem, const ModesFit& nothing) {
  using What = Disturbed::What;
  std::vector<Disturbed> all;
  const auto& measured = problem.measured();
  const auto add = [&](What what, Index count, Index least) {
    for (Index i = 0; count > least && i < count; ++i) all.push_back({what, i});
  };
  add(What::mode, measured.count(), 3);
  add(What::sensor, measured.output_shapes.rows(), 2);
  add(What::actuator, measured.input_shapes.rows(), 2);
  std::vector<ModesFit> fits(all.size());
  parallel_tasks(all.size(), [&](std::size_t i) {
    ModesFit start = nothing;
    start.disturbed = all[i];
    fits[i] = problem.fitted(start, kQuickRounds);
  });
  sort(fits);
  return fits;
}

// Deviations of the coordinates of the last cause where its place, its extent and its other forms
// are held. A mass on a node of a mode may be known by its effect and not by its size: what it
// changes is certain, and so is that it is there.
Eigen::VectorXd deviations_in_place(const ModesProblem& problem, const ModesFit& fit) {
  using Role = Parameter::Role;
  Index first = 0;
  for (const auto& other : fit.causes) first += other.x.size();
  const auto& cause = fit.causes.back();
  first -= cause.x.size();
  std::vector<Index> held;
  const auto parameters = cause.effect->parameters(problem.structure());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto role = parameters[i].role;
    const bool is_held = parameters[i].is_place() || role == Role::extent || role == Role::shape;
    if (is_held) held.push_back(first + static_cast<Index>(i));
  }
  Eigen::VectorXd variance = fit.covariance.diagonal().segment(first, cause.x.size());
  if (!held.empty()) {
    const Eigen::MatrixXd beside = fit.covariance(held, Eigen::seqN(first, cause.x.size()));
    const Eigen::LDLT<Eigen::MatrixXd> of_held(Eigen::MatrixXd(fit.covariance(held, held)));
    const Eigen::MatrixXd explained = beside.transpose() * of_held.solve(beside);
    variance = (variance - explained.diagonal()).cwiseMax(0.0);
  }
  return variance.cwiseSqrt();
}

// The deviation that a sound structure may have of the same kind: the tolerance, or its level.
double usual_size(const ModesProblem& problem, const ModesFit& fit, const Effect& effect) {
  if (effect.tolerance == nullptr) return 0.0;
  const double stated = problem.tolerances().*effect.tolerance;
  const auto level = [&](ErrorClass of) { return fit.levels(static_cast<int>(of)); };
  if (effect.tolerance == &Tolerances::gain) return std::max(stated, level(ErrorClass::gain));
  if (effect.tolerance == &Tolerances::position) return std::max(stated, level(ErrorClass::place));
  return stated;
}

// True if a size of the last cause differs from that of a sound structure by more than its
// deviation and more than such structures differ. The size of a cause without a strength is its
// frequency; a cause without both is there or not.
bool is_significant(const ModesProblem& problem, const ModesFit& fit) {
  using Role = Parameter::Role;
  const auto& cause = fit.causes.back();
  const auto parameters = cause.effect->parameters(problem.structure());
  const auto is_strength = [](const Parameter& parameter) {
    return parameter.role == Role::strength || parameter.role == Role::offset;
  };
  const bool has_strength = std::ranges::any_of(parameters, is_strength);
  const auto is_size = [&](const Parameter& parameter) {
    return has_strength ? is_strength(parameter) : parameter.role == Role::frequency;
  };
  if (std::ranges::none_of(parameters, is_size)) return true;
  const auto deviation = deviations_in_place(problem, fit);
  const double usual = usual_size(problem, fit, *cause.effect);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!is_size(parameters[i])) continue;
    const double std = deviation(static_cast<Index>(i));
    const double size = std::abs(cause.x(static_cast<Index>(i)));
    const bool is_clear = parameters[i].is_about_zero()
                              ? size > kConstants.significant * std::max(std, usual)
                              : std < kConstants.determined;
    if (is_clear) return true;
  }
  return false;
}

// The fit without a cause, with the pairs of any of the fits if they are more probable there: a
// small cause may have let the modes be paired anew, and is not what explains them.
ModesFit paired_as(const ModesProblem& problem, ModesFit nothing,
                   const std::vector<ModesFit>& fits) {
  std::vector<std::vector<Index>> tried{nothing.matching.model};
  for (const auto& fit : fits) {
    if (fit.model.count() != nothing.model.count()) continue;
    if (std::ranges::find(tried, fit.matching.model) != tried.end()) continue;
    tried.push_back(fit.matching.model);
    ModesFit start = nothing;
    start.matching = fit.matching;
    start.levels = fit.levels;
    auto other = problem.fitted(start);
    if (other.log_evidence > nothing.log_evidence) nothing = std::move(other);
  }
  return nothing;
}

}  // namespace

ModesFound searched(const ModesProblem& problem, const std::vector<const Effect*>& catalogue,
                    int most_causes, double least_evidence, const Progress& progress) {
  ModesFound found;
  found.nothing = problem.nothing();
  found.disturbed = disturbed_fits(problem, found.nothing);
  std::vector<ModesFit> beam{found.nothing};
  for (int level = 0; level < most_causes; ++level) {
    tell(progress, level == 0 ? "one cause" : level == 1 ? "two causes" : "three causes");
    std::vector<ModesFit> next;
    for (const auto& base : beam) {
      double effects = 0.0;
      const auto starts = candidates(problem, base, catalogue, effects);
      if (level == 0) found.effects = effects;
      auto fits = fitted_with(problem, base, starts);
      if (level == 0) found.nothing = paired_as(problem, found.nothing, fits);
      // The others were significant when they were found. What a further cause leaves of them is
      // told by the evidence without them.
      std::erase_if(fits, [&](const ModesFit& fit) { return !is_significant(problem, fit); });
      std::ranges::move(fits, std::back_inserter(next));
    }
    if (next.empty()) break;
    sort(next);
    // A further cause that brings less is not named, but from Constants::rival_evidence on it is
    // part of a rival.
    const double more =
        level == 0 ? least_evidence : std::max(least_evidence, kConstants.sure_evidence);
    const double needed =
        level == 0 ? -HUGE_VAL : beam.front().log_evidence + kConstants.rival_evidence;
    for (const auto& fit : next) {
      if (fit.log_evidence >= needed) found.fits.push_back(fit);
    }
    const double gain = next.front().log_evidence - beam.front().log_evidence;
    if (gain < more) break;
    next.resize(std::min(next.size(), kBeam));
    const double least = next.front().log_evidence - kConstants.beam_within;
    std::erase_if(next, [&](const ModesFit& fit) { return fit.log_evidence < least; });
    beam = std::move(next);
  }
  sort(found.fits);
  return found;
}

}  // namespace chladni::diagnosis
