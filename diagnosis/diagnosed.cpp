#include "diagnosis/diagnosed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "diagnosis/measure_next.h"
#include "diagnosis/nonlinearity.h"
#include "diagnosis/prepared.h"
#include "diagnosis/scene.h"
#include "diagnosis/simpler.h"
#include "diagnosis/superclass.h"
#include "diagnosis/verdict.h"
#include "priors/dense.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr double kHardlyByChance = 0.05;

// The last word: the best few fits again on more lines and with the errors of the mode shapes,
// which the search saw as noise; then without what that leaves too little evidence for.
Found refined(const Problem& problem, const Found& found, const SearchLimits& limits) {
  constexpr std::size_t kMost = 3;
  const auto again = [&](const Fit& fit) {
    return fitted(problem, with_deviations(fit, problem.deviations.size()));
  };
  Found fine;
  fine.nothing = again(found.nothing);
  const double best = found.fits.front().log_evidence;
  std::vector<const Fit*> taken;
  for (const auto& fit : found.fits) {
    if (fit.causes.empty()) continue;
    const bool close = best - fit.log_evidence < 60.0 && taken.size() < kMost;
    const bool known = std::ranges::any_of(
        taken, [&](const Fit* other) { return alike(problem.structure, *other, fit); });
    if (known || !(close || &fit == &found.fits.front())) continue;
    taken.push_back(&fit);
    fine.fits.push_back(again(fit));
  }
  fine.fits.push_back(fine.nothing);
  std::ranges::stable_sort(fine.fits, std::greater{}, &Fit::log_evidence);
  const auto count = fine.fits.front().causes.size();
  if (count == 0) return fine;
  Fit simpler = pruned(problem, fine.fits.front(), fine.nothing, limits);
  if (simpler.causes.size() < count) {
    // What was more is not worth its evidence: it is no rival either.
    std::erase_if(fine.fits,
                  [&](const Fit& fit) { return fit.causes.size() >= simpler.causes.size(); });
    fine.fits.insert(fine.fits.begin(), std::move(simpler));
  } else {
    fine.fits.front() = std::move(simpler);  // the same, with what it is without each cause
  }
  add_simpler(problem, fine);
  return fine;
}

// Where the place of the best explanation's first cause in a place may be.
CauseMap map_of(const Problem& problem, const Fit& best) {
  Fit without = best;
  const auto placed = std::ranges::find_if(without.causes, [&](const Supposed& cause) {
    return place_of(cause, problem.structure).has_value();
  });
  const bool named = placed != without.causes.end();
  if (named) without.causes.erase(placed);
  const State state = state_of(problem, without.causes, without.eta);
  const Solved now = solved(state, Body(state, problem.observed.omega));
  const double misfit = residual(problem.observed, now.value).squaredNorm();
  const auto scan = place_scan(problem.structure, problem.observed, now, state);
  CauseMap map;
  map.explained = scan.explained / std::max(misfit - problem.observed.number_count(), 1.0);
  map.posterior = Eigen::VectorXd::Zero(scan.explained.size());
  if (!named || scan.explained.size() == 0) return map;
  map.posterior = (0.5 * (scan.explained.array() - scan.explained.maxCoeff())).max(-700.0).exp() *
                  problem.structure.surface.area.array();
  map.posterior /= map.posterior.sum();
  return map;
}

// The fit that an explanation was made of.
const Fit& told_by(const Found& found, const Explanation& explanation) {
  return *std::ranges::min_element(found.fits, {}, [&](const Fit& fit) {
    return std::abs(fit.log_evidence - found.nothing.log_evidence - explanation.log_evidence) +
           (fit.causes.size() == explanation.causes.size() ? 0.0 : 1e300);
  });
}

std::vector<std::string> breaches_of(const Problem& problem, const Fit& fit) {
  std::vector<std::string> all;
  for (Index i = 0; i < fit.eta.size(); ++i) {
    if (std::abs(fit.eta(i)) <= 3.0) continue;
    all.push_back(fmt::format("{}: {:+.1f} tolerances",
                              problem.deviations[static_cast<std::size_t>(i)].name, fit.eta(i)));
  }
  return all;
}

std::string note_on_places(const Structure& structure, const Explanation& told) {
  if (by_chance_so_near(structure, told.causes) > kHardlyByChance) return "";
  return "causes of one kind are nearer to each other than chance would have them: they may be one "
         "thing that is spread out, which the catalogue lacks";
}

// All but the notes.
Diagnosis told_of(const Problem& problem, const Found& found, const DiagnosisOptions& options) {
  auto told = explanations(problem, found, options.rival_within);
  Diagnosis diagnosis;
  diagnosis.verdict = judged(problem, found, told, options);
  diagnosis.excess_before = found.nothing.excess(problem.observed.number_count());
  diagnosis.best = told.front();
  diagnosis.rivals.assign(told.begin() + 1, told.end());
  diagnosis.before = residue(problem, found.nothing);
  const auto& best = told_by(found, told.front());
  diagnosis.after = residue(problem, best);
  diagnosis.map = map_of(problem, best);
  if (diagnosis.verdict == Verdict::ambiguous) {
    diagnosis.measure_next = measure_next(problem, best, told_by(found, told[1]));
  }
  diagnosis.breaches = breaches_of(problem, best);
  if (diagnosis.verdict == Verdict::unexplained || diagnosis.verdict == Verdict::partial) {
    tell(options.progress, "where the unknown acts");
    // Where no cause is believed, the unknown acts on the simulation itself.
    const bool believed = diagnosis.verdict == Verdict::partial;
    diagnosis.superclass = superclass(problem, believed ? best : found.nothing);
  }
  return diagnosis;
}

}  // namespace

std::vector<const Effect*> catalogue_of(const DiagnosisOptions& options) {
  std::vector<const Effect*> all;
  for (const auto* one : effects()) {
    if (options.only.empty() || std::ranges::find(options.only, one->name) != options.only.end()) {
      all.push_back(one);
    }
  }
  for (const auto& name : options.only) (void)effect(name);  // an unknown one is told
  return all;
}

Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                    const DiagnosisOptions& options) {
  const priors::dense::OneThread one;  // the tasks of the search are what runs side by side
  const auto given = prepared(structure, measured, options.tolerances);
  SearchLimits limits;
  limits.most_causes = options.most_causes;
  limits.least_evidence = options.least_evidence;
  limits.unseen = given.shapes;
  const Observed coarse = given.for_search(options.lines);
  const Found first = searched({*given.structure, coarse, given.tolerable}, catalogue_of(options),
                               limits, options.progress);
  tell(options.progress, "the last word");
  const Observed fine = thinned(given.observed, 2 * options.lines);
  const auto deviations = given.all_deviations();
  const Problem problem{*given.structure, fine, deviations};
  Diagnosis diagnosis = told_of(problem, refined(problem, first, limits), options);
  auto notes = given.notes;
  notes.push_back(nonlinearity_note(measured));
  notes.push_back(note_on_places(*given.structure, diagnosis.best));
  std::erase(notes, "");
  diagnosis.notes = std::move(notes);
  return diagnosis;
}

}  // namespace chladni::diagnosis
