#include "diagnosis/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/readings/readings.h"
#include "diagnosis/search/elsewhere.h"
#include "diagnosis/search/hints.h"
#include "diagnosis/search/overlap.h"
#include "diagnosis/search/scene.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/search/starts.h"
#include "diagnosis/search/without_causes.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A possible further cause, with its misfit in a scene.
struct Candidate {
  Supposed cause;
  double misfit = 0.0;
  const Fit* base = nullptr;
  bool from_nominal = false;  ///< found with the tolerances at 0
};

double numbers(const Problem& problem) { return problem.observed.number_count(); }

struct Level {
  const Problem& problem;
  const std::vector<const Effect*>& catalogue;
  const SearchLimits& limits;
  const Progress& progress;
  int number = 0;
  bool down_to_noise = false;  ///< only noise is left: try only effects that are too small to show
};

// All causes that might be added to `base`, the most promising first; at most two per effect.
std::vector<Candidate> looked_at(const Level& level, const Fit& base, bool nominal) {
  Fit seen = base;
  if (nominal) seen.eta.setZero();
  const Observed few = thinned(level.problem.observed, level.limits.lines_of_scene);
  const Problem coarse{level.problem.structure, few, level.problem.deviations};
  const State state = state_of(coarse, seen.causes, seen.eta);
  const Solved now = solved(state, Body(state, few.omega));
  const Scene scene(coarse.structure, few, state, tolerated_variance(coarse, seen, now));
  std::vector<std::vector<Candidate>> each(level.catalogue.size());
  const auto caller = std::this_thread::get_id();
  parallel_tasks(each.size(), [&](std::size_t e) {
    throw_if_interrupted();
    if (std::this_thread::get_id() == caller) {  // only the calling thread may report progress
      tell(level.progress, fmt::format("cause {}: {}", level.number, level.catalogue[e]->name),
           static_cast<double>(e) / static_cast<double>(each.size()));
    }
    for (auto& start : best_starts(scene, *level.catalogue[e])) {
      each[e].push_back({std::move(start.cause), start.misfit, &base, nominal});
    }
  });
  std::vector<Candidate> candidates;
  for (auto& of_effect : each) {
    for (auto& candidate : of_effect) {
      if (is_there_already(level.problem.structure, base, candidate.cause)) continue;
      candidate.misfit -= scene.misfit();  // the fall of χ², which can be compared between scenes
      candidates.push_back(std::move(candidate));
    }
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::misfit);
  return candidates;
}

std::optional<Fit> fitted_from(const Level& level, const Candidate& candidate, bool nominal,
                               double bar) {
  Fit start = *candidate.base;
  if (nominal) start.eta.setZero();
  start.causes.push_back(candidate.cause);
  FitLimits quick;
  quick.iterations = level.limits.fit_iterations;
  quick.tolerance = kConstants.quick_tolerance;
  quick.bar = bar;
  return possible_fit(level.problem, start, quick);
}

// Fits first from the tolerances with which the candidate was found. If the evidence falls below
// that of the base, it also fits from the other tolerances (0 or fitted), and the better fit is
// returned.
std::optional<Fit> fitted_with(const Level& level, const Candidate& candidate, double bar) {
  auto fit = fitted_from(level, candidate, candidate.from_nominal, bar);
  if (fit && fit->log_evidence >= candidate.base->log_evidence) return fit;
  auto other = fitted_from(level, candidate, !candidate.from_nominal, bar);
  if (!fit || (other && other->log_evidence > fit->log_evidence)) return other;
  return fit;
}

// True if the residual is so large that it stretches the tolerances far.
bool is_large(const Level& level, const Fit& base) {
  const double stretch = base.eta.squaredNorm() / static_cast<double>(base.eta.size());
  return level.number == 1 && stretch > kConstants.large_stretch &&
         base.excess(numbers(level.problem)) > kConstants.large_excess;
}

// Looks for large causes with the tolerances at 0. Small causes hide in fitted tolerances, so it
// looks for them with these. In between it does both.
std::vector<Candidate> candidates_of(const Level& level, const Fit& base) {
  const double stretch = base.eta.squaredNorm() / static_cast<double>(base.eta.size());
  const bool large = is_large(level, base);
  std::vector<Candidate> candidates;
  if (!large) candidates = looked_at(level, base, false);
  if (large || (level.number == 1 && stretch > kConstants.small_stretch)) {
    for (auto& candidate : looked_at(level, base, true)) candidates.push_back(std::move(candidate));
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::misfit);
  return candidates;
}

// Adds causes that the scene cannot show. They are of first order, so not if very much is left.
void add_hints(const Level& level, const Fit& base, std::vector<Candidate>& chosen) {
  const bool hopeless = base.excess(numbers(level.problem)) > kConstants.hopeless_excess;
  if (is_large(level, base) && hopeless) return;
  const Observed few = thinned(level.problem.observed, level.limits.lines_of_scene);
  std::vector<Deviation> free = level.problem.deviations;
  free.insert(free.end(), level.limits.unseen.begin(), level.limits.unseen.end());
  const Problem coarse{level.problem.structure, few, free};
  Fit about = base;
  about.eta = VectorXd::Zero(static_cast<Index>(free.size()));
  about.eta.head(base.eta.size()) = base.eta;
  const double times = numbers(level.problem) / numbers(coarse);
  int taken = 0;
  for (const auto& hint :
       hints(coarse, about, level.catalogue, {level.limits.least_evidence, times})) {
    if (taken == kConstants.hints_per_level) break;
    if (is_there_already(level.problem.structure, base, hint.cause)) continue;
    chosen.push_back({hint.cause, -2.0 * hint.log_evidence, &base, false});
    ++taken;
  }
}

// The most promising candidates, each effect and choice once, and the hints.
std::vector<Candidate> worth_fitting(const Level& level, const Fit& base) {
  std::vector<Candidate> chosen;
  auto seen = level.down_to_noise ? std::vector<Candidate>{} : candidates_of(level, base);
  for (auto& candidate : seen) {
    if (static_cast<int>(chosen.size()) >= level.limits.fits_per_level) break;
    const bool again = std::ranges::any_of(chosen, [&](const Candidate& other) {
      return other.cause.effect == candidate.cause.effect &&
             other.cause.option == candidate.cause.option;
    });
    if (!again) chosen.push_back(std::move(candidate));
  }
  if (!level.limits.is_look) add_hints(level, base, chosen);
  return chosen;
}

// Fits with the last cause of `fit` at other places.
std::vector<std::optional<Fit>> fitted_elsewhere(const Level& level, const Fit& base,
                                                 const Fit& fit, double bar) {
  const Observed few = thinned(level.problem.observed, level.limits.lines_of_scene);
  const Problem coarse{level.problem.structure, few, level.problem.deviations};
  const auto places = elsewhere(coarse, base, fit.causes.back());
  std::vector<std::optional<Fit>> fits(places.size());
  parallel_tasks(fits.size(), [&](std::size_t i) {
    fits[i] = fitted_from(level, {places[i], 0.0, &base, false}, false, bar);
  });
  return fits;
}

// The best of these fits whose last cause may be a special case of what acts over an extent, with
// that instead; none where only noise is left. Such a start is far from its fit: there is no bar.
std::vector<std::optional<Fit>> fitted_spread_out(const Level& level,
                                                  const std::vector<Fit>& grown) {
  std::vector<std::optional<Fit>> fits;
  if (grown.front().excess(numbers(level.problem)) < kConstants.noise_excess) return fits;
  for (const auto& fit : grown) {
    auto starts = spread_out(level.problem, fit, level.catalogue);
    if (starts.empty()) continue;
    Fit beside = fit;
    beside.causes.pop_back();
    for (auto& start : starts) {
      fits.push_back(fitted_from(level, {std::move(start), 0.0, &beside, false}, false, HUGE_VAL));
    }
    break;
  }
  return fits;
}

// Fits with one more cause for each explanation of the beam. Two are fitted at once for any number
// of threads, so that later fits always meet the same limit.
std::vector<Fit> level_up(const Level& level, const std::vector<Fit>& beam, double bar = HUGE_VAL) {
  const std::size_t at_once = kConstants.fits_at_once;
  std::vector<Fit> grown;
  const Fit* under_best = nullptr;
  for (const auto& base : beam) {
    const auto chosen = worth_fitting(level, base);
    for (std::size_t first = 0; first < chosen.size(); first += at_once) {
      std::vector<std::optional<Fit>> fits(std::min(at_once, chosen.size() - first));
      tell(level.progress,
           fmt::format("cause {}: fitting {}", level.number, chosen[first].cause.effect->name));
      parallel_tasks(fits.size(),
                     [&](std::size_t i) { fits[i] = fitted_with(level, chosen[first + i], bar); });
      for (auto& fit : fits) {
        if (!fit || overlaps_itself(level.problem.structure, *fit)) continue;
        bar = std::min(bar, fit->objective + kConstants.occam_margin);
        if (grown.empty() || fit->log_evidence > grown.front().log_evidence) under_best = &base;
        keep(grown, std::move(*fit));
      }
    }
  }
  if (under_best == nullptr || level.limits.is_look) return grown;
  auto more = fitted_elsewhere(level, *under_best, grown.front(), bar);
  std::ranges::move(fitted_spread_out(level, grown), std::back_inserter(more));
  for (auto& fit : more) {
    if (fit && !overlaps_itself(level.problem.structure, *fit)) keep(grown, *std::move(fit));
  }
  return grown;
}

// Exchanges each cause in turn for the one that fits best in its place, until all have been tested,
// because the first cause was chosen before the others were known. Nearly equal fits become rivals.
Fit exchanged(const Level& level, Fit best, Found& found) {
  std::size_t untested = best.causes.size();  // a cause that came in last was the best
  for (std::size_t c = 0; c < untested;) {
    auto grown = level_up(level, {without(level.problem, best, c, found.nothing)},
                          best.objective + kConstants.occam_margin);
    for (const auto& fit : grown) {
      if (fit.log_evidence > best.log_evidence - level.limits.beam_within) keep(found.fits, fit);
    }
    const double enough = best.log_evidence + kConstants.exchange_gain;
    if (grown.empty() || grown.front().log_evidence <= enough) {
      ++c;
      continue;
    }
    // The same cause with a better size passes and is now the last. After another cause all are
    // tested.
    const bool same = alike(level.problem.structure, best, grown.front());
    best = std::move(grown.front());
    untested = same ? untested - 1 : best.causes.size() - 1;
    if (!same) c = 0;
  }
  return best;
}

// The causes that are worth their evidence, after exchanges. There is no exchange if the causes
// explain so little that none is believed, or if all of them are small.
Fit settled(const Level& level, Found& found) {
  const Fit simpler = pruned(level.problem, found.fits.front(), found.nothing, level.limits);
  const double n = numbers(level.problem);
  const double left = simpler.excess(n);
  const double before = found.nothing.excess(n);
  const bool hopeless = left > kConstants.hopeless_excess;
  if (hopeless && left > kConstants.left_at_most * before) return simpler;
  // With a single cause, its alternatives were already tried.
  if (before < kConstants.noise_excess || simpler.causes.size() < 2) return simpler;
  Level again = level;
  again.number = static_cast<int>(simpler.causes.size());
  const Fit other = exchanged(again, simpler, found);
  if (other.log_evidence <= simpler.log_evidence) return simpler;
  return pruned(level.problem, other, found.nothing, level.limits);
}

// Puts the best fit first, after all its causes were tested together.
void put_settled_first(const Level& level, Found& found) {
  const auto count = found.fits.front().causes.size();
  Fit best = settled(level, found);
  if (best.causes.size() == count) {
    const bool better = best.log_evidence > found.fits.front().log_evidence;
    if (better) keep(found.fits, std::move(best));
    return;
  }
  // A fit with more causes is not worth its evidence, so it is not a rival either.
  std::erase_if(found.fits, [&](const Fit& fit) { return fit.causes.size() > best.causes.size(); });
  found.fits.insert(found.fits.begin(), std::move(best));
}

// Adds one cause after the other to the beam, until one more brings too little. A fit of one cause
// that `also` is given competes with those found with the first.
void grow(Level level, std::vector<Fit> beam, Found& found, std::optional<Fit> also = {}) {
  const auto& limits = level.limits;
  for (; level.number <= limits.most_causes; ++level.number) {
    const double best_before = found.fits.front().log_evidence;
    const double left = beam.front().excess(numbers(level.problem));
    level.down_to_noise = level.number > 1 && left < kConstants.noise_excess;
    if (level.down_to_noise) beam.resize(1);
    auto grown = level_up(level, beam);
    if (also) keep_if_new(level.problem.structure, grown, *std::exchange(also, std::nullopt));
    for (const auto& fit : grown) keep(found.fits, fit);
    if (grown.empty() || grown.front().log_evidence < best_before + limits.least_evidence) break;
    const bool sure = is_sure(level.problem, limits, found.nothing, beam.front(), grown.front());
    if (level.down_to_noise && !sure) break;
    while (static_cast<int>(grown.size()) > limits.beam ||
           grown.back().log_evidence < grown.front().log_evidence - limits.beam_within) {
      grown.pop_back();
    }
    beam = std::move(grown);
  }
}

// Searches with any gain allowed in each channel, then fits without these gains. Returns the best
// fit for each number of causes.
std::vector<Fit> with_free_gains(const Level& level) {
  Tolerances any_gain = no_tolerances();
  any_gain.gain = kConstants.free_gain;
  const auto& [structure, observed, tolerable, solver_error] = level.problem;
  auto free = deviations(structure, any_gain, 0.0);
  free.insert(free.begin(), tolerable.begin(), tolerable.end());
  std::vector<const Effect*> catalogue = level.catalogue;
  std::erase_if(catalogue, [](const Effect* effect) { return effect->is_gain; });
  const Problem problem{structure, observed, free, solver_error};
  Fit rest;
  rest.eta = VectorXd::Zero(std::ssize(free));
  Found found{fitted(problem, rest), {}};
  found.fits = {found.nothing};
  grow({problem, catalogue, level.limits, level.progress, 1}, {found.nothing}, found);
  std::vector<Fit> best;
  for (const auto& fit : found.fits) {
    if (fit.causes.empty() || std::ranges::any_of(best, [&](const Fit& other) {
          return other.causes.size() == fit.causes.size();
        })) {
      continue;
    }
    auto again = possible_fit(level.problem, with_deviations(fit, tolerable.size()));
    if (again) best.push_back(*std::move(again));
  }
  return best;
}

// Grows explanations from the channels as they seem to be read (readings.h). Readings do not count
// among SearchLimits::most_causes, and large causes are looked for beside them. Where that is one
// cause at most, or leaves much, also from nothing. Returns the readings.
std::vector<Supposed> grow_from_readings(const Level& level, Found& found) {
  const Fit nothing = found.nothing;
  auto read =
      fitted_with_readings(level.problem, level.catalogue, nothing, level.limits.least_evidence);
  const auto causes = read ? read->causes : std::vector<Supposed>{};
  if (causes.size() < 2) {
    grow(level, {nothing}, found, std::move(read));
    return causes;
  }
  keep(found.fits, *read);
  grow(level, {*std::move(read)}, found);
  const double left = found.fits.front().excess(numbers(level.problem));
  const double before = nothing.excess(numbers(level.problem));
  if (left < kConstants.large_excess || left < kConstants.left_at_most * before) return causes;
  Found otherwise{nothing, {nothing}};
  grow(level, {nothing}, otherwise);
  for (auto& fit : otherwise.fits) {
    keep_if_new(level.problem.structure, found.fits, std::move(fit));
  }
  return causes;
}

}  // namespace

Found searched(const Problem& problem, const std::vector<const Effect*>& catalogue,
               const SearchLimits& limits, const Progress& progress, const VectorXd& start) {
  const dense::OneBlasThread one_thread;
  tell(progress, "the simulation within its tolerances");
  Found found = fitted_without_causes(problem, start);
  const auto read = grow_from_readings({problem, catalogue, limits, progress, 1}, found);
  fit_nothing_again(problem, found);
  if (limits.is_look) return found;
  // Resonances may be so wrong that a zero response would be almost as good. Then a cause that
  // makes the responses smaller seems to explain the data, and the real cause does not.
  if (found.fits.front().chi_square > kConstants.lost_power * problem.observed.power()) {
    const auto count = found.fits.front().causes.size();
    for (auto& fit : with_free_gains({problem, catalogue, limits, progress, 1})) {
      keep(found.fits, std::move(fit));
    }
    const Fit best = found.fits.front();
    const int next = static_cast<int>(best.causes.size()) + 1;
    const bool is_new = best.causes.size() != count;
    if (is_new) grow({problem, catalogue, limits, progress, next}, {best}, found);
  }
  if (found.fits.front().causes.size() > 1) {
    put_settled_first({problem, catalogue, limits, progress, 1}, found);
  }
  auto lost = fitted_with_lost(problem, read, found.fits.front(), limits.least_evidence);
  if (lost) keep(found.fits, *std::move(lost));
  return found;
}

}  // namespace chladni::diagnosis
