#include "diagnosis/modes/search/modes_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/search/modes_look.h"
#include "diagnosis/modes/significance.h"
#include "diagnosis/modes/weighed.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kPerEffect = 3;  // starts of one effect that are fitted in full, at most
constexpr std::size_t kMoved = 3;      // starts of one effect, and of other sizes, that are moved
constexpr std::size_t kLookedAt = 24;  // starts that are fitted in two rounds, per level
constexpr std::size_t kInFull = 8;     // of these, fitted in full
constexpr int kQuickRounds = 2;        // of such a first fit
constexpr std::size_t kRevised = 4;    // fits whose earlier causes are sought again
constexpr std::size_t kBeam = 2;       // fits from which a further cause is sought

struct Candidate {
  Supposed cause;
  PerClass levels = PerClass::Zero();
  double objective = 0.0;  // after a move −ln evidence
};

// Coordinate of the frequency of a cause that is tuned.
double frequency_of(const ModesProblem& problem, const Supposed& cause) {
  const auto parameters = cause.effect->parameters(problem.structure());
  const auto found = std::ranges::find(parameters, Parameter::Role::frequency, &Parameter::role);
  return cause.x(found - parameters.begin());
}

// One cause of both, at another size.
bool is_same(const ModesProblem& problem, const Supposed& a, const Supposed& b) {
  return alike(problem.structure(), a, b) &&
         (!is_tuned(problem.structure(), *a.effect) ||
          std::abs(frequency_of(problem, a) - frequency_of(problem, b)) <
              kConstants.same_frequency);
}

// The best of them, each of another choice or place.
std::vector<Candidate> first_of(const ModesProblem& problem, std::vector<Candidate> all,
                                std::size_t most) {
  std::ranges::stable_sort(all, {}, &Candidate::objective);
  std::vector<Candidate> best;
  for (auto& candidate : all) {
    if (best.size() == most) break;
    const bool is_new = std::ranges::none_of(best, [&](const Candidate& other) {
      return is_same(problem, candidate.cause, other.cause);
    });
    if (is_new) best.push_back(std::move(candidate));
  }
  return best;
}

// What tells the starts of one effect apart, wherever they are: the frequency of what is tuned,
// else all coordinates but the place.
Eigen::VectorXd coordinates_without_place(const ModesProblem& problem, const Supposed& cause) {
  if (is_tuned(problem.structure(), *cause.effect)) {
    return Eigen::VectorXd::Constant(1, frequency_of(problem, cause));
  }
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
  std::vector<Eigen::VectorXd> known;
  for (const auto& one : some) known.push_back(coordinates_without_place(problem, one.cause));
  std::ranges::stable_sort(all, {}, &Candidate::objective);
  for (const auto& candidate : all) {
    if (some.size() == most) break;
    auto x = coordinates_without_place(problem, candidate.cause);
    if (std::ranges::find(known, x) != known.end()) continue;
    some.push_back(candidate);
    known.push_back(std::move(x));
  }
  return some;
}

// The best starts of one effect, at places and choices of their own. The best of the grid at each
// of the levels are moved first: neighbours on it may differ by more than the errors are.
std::vector<Candidate> best_of(const ModesLook& look, const ModesProblem& problem,
                               const Effect& effect, StartSizes start_sizes) {
  const auto& levels = look.levels();
  std::vector<std::vector<Candidate>> at_level(levels.size());
  for (const auto& start :
       grid_of(problem.structure(), effect, problem.measured().frequency_hz, start_sizes)) {
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
    const auto modes = static_cast<std::size_t>(problem.measured().count());
    const std::size_t sizes =
        i == 0 && is_tuned(problem.structure(), effect) ? kMoved + modes : most;
    for (auto& one : to_move(problem, std::move(at_level[i]), most, sizes)) {
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
  // A measured mode that nothing is like may be one that a spring makes of a rigid body.
  const auto sizes = count_alone(base.matching) > 0 ? StartSizes::near : StartSizes::usual;
  std::vector<std::vector<Candidate>> best(catalogue.size());
  parallel_tasks(catalogue.size(),
                 [&](std::size_t e) { best[e] = best_of(look, problem, *catalogue[e], sizes); });
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

// The likeliest fits, those with other last causes first: near places often lead to one maximum.
std::vector<ModesFit> likeliest(const ModesProblem& problem, std::vector<ModesFit> fits,
                                std::size_t most) {
  sort(fits);
  std::vector<ModesFit> first, more;
  for (auto& fit : fits) {
    const bool is_new = std::ranges::none_of(first, [&](const ModesFit& other) {
      return is_same(problem, fit.causes.back(), other.causes.back());
    });
    (is_new ? first : more).push_back(std::move(fit));
  }
  std::ranges::move(more, std::back_inserter(first));
  if (first.size() > most) first.resize(most);
  return first;
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
  fits = likeliest(problem, std::move(fits), kInFull);
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

// True if one of the fits is of the same explanation.
bool is_among(const ModesProblem& problem, const ModesFit& fit, const std::vector<ModesFit>& fits) {
  return std::ranges::any_of(
      fits, [&](const ModesFit& other) { return are_alike(problem.structure(), fit, other); });
}

// Each explanation once, at its best fit. `fits` are sorted.
std::vector<ModesFit> distinct(const ModesProblem& problem, const std::vector<ModesFit>& fits) {
  std::vector<ModesFit> all;
  for (const auto& fit : fits) {
    if (!is_among(problem, fit, all)) all.push_back(fit);
  }
  return all;
}

// A first cause was chosen beside none, and may stand where the last one belongs. The best fits
// without each of their causes but the last, at sizes that suit what is left, where they are not
// among those from which all causes were sought.
std::vector<ModesFit> without_earlier(const ModesProblem& problem,
                                      const std::vector<ModesFit>& fits,
                                      const std::vector<ModesFit>& sought) {
  std::vector<ModesFit> bases;
  const auto best = distinct(problem, fits);
  for (std::size_t i = 0; i < std::min(best.size(), kRevised); ++i) {
    if (best[i].log_evidence < best.front().log_evidence - kConstants.beam_within) break;
    for (std::size_t c = 0; c + 1 < best[i].causes.size(); ++c) {
      ModesFit base = best[i];
      base.causes.erase(base.causes.begin() + static_cast<std::ptrdiff_t>(c));
      const bool is_known = is_among(problem, base, bases) || is_among(problem, base, sought);
      if (!is_known) bases.push_back(std::move(base));
    }
  }
  parallel_tasks(bases.size(), [&](std::size_t i) { bases[i] = problem.fitted(bases[i]); });
  std::erase_if(bases, [](const ModesFit& base) { return !std::isfinite(base.log_evidence); });
  return bases;
}

// Effects of the causes of fits, each once.
std::vector<const Effect*> effects_of(const std::vector<ModesFit>& fits) {
  std::vector<const Effect*> all;
  for (const auto& fit : fits) {
    for (const auto& cause : fit.causes) {
      if (std::ranges::find(all, cause.effect) == all.end()) all.push_back(cause.effect);
    }
  }
  return all;
}

// What a search has found so far.
struct Finds {
  ModesFound& found;
  double least_evidence;
  /// Fits that bring least_evidence by a last cause whose size is not known.
  std::vector<ModesFit> unclear = {};
};

// Fits whose last cause is significant. The others were when they were found, and what a further
// cause leaves of them is told by the evidence without them.
std::vector<ModesFit> significant(const ModesProblem& problem, std::vector<ModesFit> fits,
                                  double before, Finds& finds) {
  for (auto& fit : fits) fit.has_clear_sizes = have_clear_sizes(problem, fit);
  const auto clear = std::stable_partition(fits.begin(), fits.end(), [&](const ModesFit& fit) {
    return is_significant(problem, fit, fit.causes.size() - 1, SizeDeviation::anywhere);
  });
  std::copy_if(clear, fits.end(), std::back_inserter(finds.unclear), [&](const ModesFit& fit) {
    return fit.log_evidence >= before + finds.least_evidence;
  });
  fits.erase(clear, fits.end());
  return fits;
}

// All fits of one cause more than each base has, sorted.
std::vector<ModesFit> with_one_more(const ModesProblem& problem, const std::vector<ModesFit>& bases,
                                    const std::vector<const Effect*>& catalogue, Finds& finds) {
  std::vector<ModesFit> next;
  for (const auto& base : bases) {
    double effects = 0.0;
    double before = base.log_evidence;
    auto fits = fitted_with(problem, base, candidates(problem, base, catalogue, effects));
    if (base.causes.empty()) {
      finds.found.effects = effects;
      finds.found.nothing = paired_as(problem, finds.found.nothing, fits);
      before = finds.found.nothing.log_evidence;
    }
    std::ranges::move(significant(problem, std::move(fits), before, finds),
                      std::back_inserter(next));
  }
  sort(next);
  return next;
}

// Adds to `next` what is found beside its best fits without an earlier cause each. Returns the best
// evidence of these bases.
double revise(const ModesProblem& problem, const std::vector<ModesFit>& beam,
              std::vector<ModesFit>& next, Finds& finds) {
  auto bases = without_earlier(problem, next, beam);
  auto revised = with_one_more(problem, bases, effects_of(next), finds);
  std::ranges::move(revised, std::back_inserter(next));
  sort(next);
  double best = -HUGE_VAL;
  for (const auto& base : bases) best = std::max(best, base.log_evidence);
  std::ranges::move(significant(problem, std::move(bases), HUGE_VAL, finds),
                    std::back_inserter(finds.found.fits));
  return best;
}

// A cause of unknown size is told by nothing but its evidence, and so not by itself. It outweighs
// what explains less, where that would be told.
void add_unclear(Finds& finds) {
  auto& found = finds.found;
  const double least = found.nothing.log_evidence + finds.least_evidence;
  const bool some = std::ranges::any_of(
      found.fits, [&](const ModesFit& fit) { return fit.log_evidence >= least; });
  if (some) std::ranges::move(finds.unclear, std::back_inserter(found.fits));
}

}  // namespace

ModesFound searched(const ModesProblem& problem, const std::vector<const Effect*>& catalogue,
                    int most_causes, double least_evidence, const Progress& progress) {
  ModesFound found;
  found.nothing = problem.nothing();
  if (problem.prior().width > 0.0) found.evidence_power = kConstants.evidence_power;
  found.disturbed = disturbed_fits(problem, found.nothing);
  std::vector<ModesFit> beam{found.nothing};
  Finds finds{found, least_evidence};
  for (int level = 0; level < most_causes; ++level) {
    tell(progress, level == 0 ? "one cause" : level == 1 ? "two causes" : "three causes");
    auto next = with_one_more(problem, beam, catalogue, finds);
    if (next.empty()) break;
    double before = beam.front().log_evidence;
    if (level > 0 && next.front().log_evidence >= before + kConstants.rival_evidence) {
      before = std::max(before, revise(problem, beam, next, finds));
    }
    // A further cause that brings less is not named, but from Constants::rival_evidence on it is
    // part of a rival.
    const double needed = level == 0 ? -HUGE_VAL : before + kConstants.rival_evidence;
    for (const auto& fit : next) {
      if (fit.log_evidence >= needed) found.fits.push_back(fit);
    }
    if (next.front().log_evidence - before < least_evidence) break;
    next = distinct(problem, next);
    next.resize(std::min(next.size(), kBeam));
    const double least = next.front().log_evidence - kConstants.beam_within;
    std::erase_if(next, [&](const ModesFit& fit) { return fit.log_evidence < least; });
    beam = std::move(next);
  }
  add_unclear(finds);
  sort(found.fits);
  return found;
}

}  // namespace chladni::diagnosis
