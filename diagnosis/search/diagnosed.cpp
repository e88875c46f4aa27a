#include "diagnosis/diagnosed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "dense/blas.h"
#include "diagnosis/calibrated_responses.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/modes/calibration/constants_told.h"
#include "diagnosis/modes/deviations_by_modes.h"
#include "diagnosis/modes/given.h"
#include "diagnosis/search/scales.h"
#include "diagnosis/search/scene.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/verdict/constants_fitted.h"
#include "diagnosis/verdict/held_out/cross_validated.h"
#include "diagnosis/verdict/last_fits.h"
#include "diagnosis/verdict/measure_next.h"
#include "diagnosis/verdict/nonlinearity.h"
#include "diagnosis/verdict/prepared.h"
#include "diagnosis/verdict/stability.h"
#include "diagnosis/verdict/superclass.h"
#include "diagnosis/verdict/verdict.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Map of the possible places of the first cause with a place in the best explanation.
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

std::vector<std::string> breaches_of(const Problem& problem, const Fit& fit) {
  std::vector<std::string> breaches;
  for (Index i = 0; i < fit.eta.size(); ++i) {
    if (std::abs(fit.eta(i)) <= kConstants.significant) continue;
    breaches.push_back(fmt::format("{}: {:+.1f} tolerances",
                                   problem.deviations[static_cast<std::size_t>(i)].name,
                                   fit.eta(i)));
  }
  return breaches;
}

std::string note_on_places(const Structure& structure, const Explanation& explanation) {
  if (by_chance_so_near(structure, explanation.causes) > kConstants.near_by_chance) return "";
  return "causes of one kind are nearer to each other than chance would have them: they may be one "
         "thing that is spread out, which the catalogue lacks";
}

// The diagnosis without its notes, and without the next measurement, which needs the last verdict.
Diagnosis told_of(const Problem& problem, const Found& found, const DiagnosisOptions& options) {
  auto explained = explanations(problem, found, options.rival_within);
  Diagnosis diagnosis;
  diagnosis.verdict = judged(problem, found, explained, options);
  diagnosis.excess_before = found.nothing.excess(problem.observed.number_count());
  diagnosis.best = explained.front();
  diagnosis.rivals.assign(explained.begin() + 1, explained.end());
  diagnosis.before = residue(problem, found.nothing);
  const auto& best = found.fits[explained.front().fit];
  diagnosis.after = residue(problem, best);
  diagnosis.map = map_of(problem, best);
  diagnosis.breaches = breaches_of(problem, best);
  if (diagnosis.verdict == Verdict::unexplained || diagnosis.verdict == Verdict::partial) {
    tell(options.progress, "where the unknown acts");
    // If no cause is believed, the unknown acts on the simulation itself.
    const bool believed = diagnosis.verdict == Verdict::partial;
    diagnosis.superclass = superclass(problem, believed ? best : found.nothing);
  }
  return diagnosis;
}

// Tests the causes on data that are held out in turn. Returns a note, or nothing.
std::string tested_on_held_out(const Prepared& given, const Problem& problem, const Found& found,
                               const DiagnosisOptions& options, Diagnosis& diagnosis) {
  const bool is_open = diagnosis.verdict == Verdict::unexplained;
  if (diagnosis.best.causes.empty() || is_open) return "";
  tell(options.progress, "data held out in turn");
  const Observed coarse = given.for_search(options.lines);
  auto tested = cross_validated({*given.structure, coarse, given.tolerable, given.solver_error},
                                given.observed, found.fits[diagnosis.best.fit], found.nothing);
  if (tested.parts.empty()) return "";
  diagnosis.cross_validation = std::move(tested);
  auto note = doubt_what_does_not_pay(diagnosis);
  if (diagnosis.verdict == Verdict::unexplained) {
    diagnosis.superclass = superclass(problem, found.nothing);
  }
  return note;
}

void tell_fitted_constants(const Prepared& given, const Calibration& calibration, const Fit& best,
                           Diagnosis& diagnosis) {
  if (calibration.constants.empty()) return;
  const auto first = static_cast<Index>(given.tolerable.size() - calibration.constants.size());
  const auto fitted = constants_of(best, calibration.constants, calibration.start, first);
  tell_constants(calibration.constants, fitted.x, fitted.covariance, diagnosis);
}

// Deviations at which the structure has the modes of the responses; empty: these are not known, or
// are not its own.
Eigen::VectorXd start_of_deviations(const Prepared& given,
                                    const std::optional<MeasuredModes>& modes) {
  if (!modes) return {};
  try {
    return deviations_by_modes(*given.structure, given.tolerable,
                               diagnosis::given(*given.structure, *modes).measured);
  } catch (const NumericalFailure&) {
    return {};
  }
}

std::vector<const Effect*> sought_in(const Structure& structure, const Calibration& calibration,
                                     const DiagnosisOptions& options) {
  return sought_beside(calibration.constants, catalogue_of(options), structure);
}

Found searched_in(const Prepared& given, const Calibration& calibration,
                  const std::optional<MeasuredModes>& modes, const DiagnosisOptions& options) {
  const Observed coarse = given.for_search(options.lines);
  return searched({*given.structure, coarse, given.tolerable, given.solver_error},
                  sought_in(*given.structure, calibration, options), limits_of(given, options),
                  options.progress, start_of_deviations(given, modes));
}

std::string note_on_starts(const Found& found) {
  if (std::abs(found.by_start) < kConstants.nothing_more) return "";
  return fmt::format(
      "without a cause, the fit that starts at the identified modes explains the responses {} than "
      "the one that starts at the simulation, by {:.3g} in ln likelihood: {}",
      found.by_start > 0.0 ? "better" : "worse", std::abs(found.by_start),
      found.by_start > 0.0 ? "it is used" : "the latter is used");
}

// Notes on the data and the constants.
std::vector<std::string> notes_of(const Prepared& given, const Calibration& calibration) {
  auto notes = given.notes;
  notes.insert(notes.end(), calibration.notes.begin(), calibration.notes.end());
  return notes;
}

// The same, and whether the body was measured as a linear one.
std::vector<std::string> data_notes_of(const Prepared& given, const Calibration& calibration,
                                       const modal::FrfSet& measured) {
  auto notes = notes_of(given, calibration);
  notes.push_back(nonlinearity_note(measured));
  std::erase(notes, "");
  return notes;
}

// What a first look tells.
Diagnosis looked_at(const Prepared& given, const Calibration& calibration,
                    const modal::FrfSet& measured, const Found& found,
                    const DiagnosisOptions& options) {
  const Observed coarse = given.for_search(options.lines);
  const Problem problem{*given.structure, coarse, given.tolerable, given.solver_error};
  Diagnosis diagnosis = told_of(problem, found, options);
  diagnosis.measure_next = measure_next(problem, found, diagnosis);
  tell_fitted_constants(given, calibration, found.fits[diagnosis.best.fit], diagnosis);
  diagnosis.notes = diagnosis.data_notes = data_notes_of(given, calibration, measured);
  return diagnosis;
}

}  // namespace

std::vector<const Effect*> catalogue_of(const DiagnosisOptions& options) {
  std::vector<const Effect*> catalogue;
  for (const auto* entry : effects()) {
    if (options.only.empty() ||
        std::ranges::find(options.only, entry->name) != options.only.end()) {
      catalogue.push_back(entry);
    }
  }
  for (const auto& name : options.only) (void)effect(name);  // an unknown name throws
  return catalogue;
}

Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                    const DiagnosisOptions& options) {
  return diagnosed(structure, measured, options, FitStart{});
}

Diagnosis diagnosed(const Structure& structure, const modal::FrfSet& measured,
                    const DiagnosisOptions& options, const FitStart& start) {
  const dense::OneBlasThread one_thread;  // the tasks of the search run in parallel instead
  const auto calibration = calibration_of(structure, options, start.constants);
  const auto given = prepared_with(structure, measured, options, calibration);
  const Found first = searched_in(given, calibration, start.modes, options);
  if (options.is_look) return looked_at(given, calibration, measured, first, options);
  tell(options.progress, "the last word");
  const Observed fine = thinned(given.observed, kConstants.last_fit_lines * options.lines);
  const auto deviations = given.all_deviations();
  const Problem problem{*given.structure, fine, deviations, given.solver_error};
  Found found = fitted_again(problem, first);
  const auto limits = limits_of(given, options);
  trim(problem, found, limits, options.rival_within);
  if (add_scales(problem, sought_in(*given.structure, calibration, options), found)) {
    trim(problem, found, limits, options.rival_within);
  }
  Diagnosis diagnosis = told_of(problem, found, options);
  const Fit& best = found.fits[diagnosis.best.fit];
  auto notes = notes_of(given, calibration);
  notes.push_back(tested_on_held_out(given, problem, found, options, diagnosis));
  notes.push_back(nonlinearity_note(measured));
  notes.push_back(note_on_places(*given.structure, diagnosis.best));
  notes.push_back(note_on_starts(first));
  notes.push_back(note_on_convergence(best, found.nothing));
  notes.push_back(note_on_noise(best, fine.number_count()));
  if (diagnosis.verdict == Verdict::unexplained) {
    notes.push_back(note_on_order(diagnosis, options.rival_within, 1.0 / temper(problem, found)));
  }
  if (is_doubtful(diagnosis, best)) {
    tell(options.progress, "the same with the last bits of the modes changed");
    const auto other = prepared_with(nudged(structure), measured, options, calibration);
    notes.push_back(doubt(*given.structure, best,
                          searched_in(other, calibration, start.modes, options), diagnosis));
  }
  diagnosis.measure_next = measure_next(problem, found, diagnosis);
  std::erase(notes, "");
  diagnosis.notes = std::move(notes);
  diagnosis.data_notes = data_notes_of(given, calibration, measured);
  tell_fitted_constants(given, calibration, best, diagnosis);
  return diagnosis;
}

}  // namespace chladni::diagnosis
