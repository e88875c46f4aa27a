#include "diagnosis/modes/modes_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/another_body.h"
#include "diagnosis/modes/calibration/calibration.h"
#include "diagnosis/modes/partner.h"
#include "diagnosis/modes/proposals/next_measurement.h"
#include "diagnosis/modes/significance.h"
#include "diagnosis/modes/weighed.h"
#include "diagnosis/verdict/cause_of.h"
#include "diagnosis/verdict/stability.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// ln evidence of the best fit without cause `which`: one with the other causes, or with none. A fit
// with the other causes may be missing, because its last cause was not significant. Its evidence
// may be higher than that of the fit with none, so the gain that follows is then an upper bound.
double evidence_without(const Structure& structure, const ModesFound& found, const ModesFit& fit,
                        std::size_t which) {
  double best = found.nothing.log_evidence;
  for (const auto& other : found.fits) {
    if (other.causes.size() + 1 != fit.causes.size()) continue;
    bool has_rest = true;
    for (std::size_t c = 0; c < fit.causes.size(); ++c) {
      has_rest = has_rest && (c == which || contains(structure, other, fit.causes[c]));
    }
    if (has_rest) best = std::max(best, other.log_evidence);
  }
  return best;
}

FrequencyErrors frequency_errors(const ModesFit& fit) {
  constexpr auto kFrequency = static_cast<Index>(ErrorClass::frequency);
  return {fit.levels(kFrequency), fit.determined(kFrequency)};
}

bool is_another_body(const Explanation& explanation) {
  return explanation.another_body > kConstants.believed;
}

Explanation explanation_of(const ModesProblem& problem, const ModesFound& found, const Weighed& all,
                           std::size_t which) {
  const auto& fit = *all.fits[which];
  Explanation explanation;
  explanation.probability = all.probability[which];
  explanation.log_evidence = fit.log_evidence - found.nothing.log_evidence;
  explanation.fit = which;
  explanation.another_body =
      of_another_body(problem.structure(), fit.causes, frequency_errors(fit));
  Index first = 0;
  for (std::size_t c = 0; c < fit.causes.size(); ++c) {
    const Index count = fit.causes[c].x.size();
    auto cause = cause_of(problem.structure(), fit.causes[c],
                          Eigen::VectorXd(fit.covariance.diagonal().segment(first, count)));
    first += count;
    cause.probability =
        (1.0 - explanation.another_body) * probability_of(problem.structure(), all, fit.causes[c]);
    // What has no known size may be something that no catalogue has.
    if (!is_significant(problem, fit, c, SizeDeviation::anywhere)) {
      cause.probability = std::min(cause.probability, kConstants.beside_unnamed);
    }
    cause.log_evidence_gain =
        fit.log_evidence - evidence_without(problem.structure(), found, fit, c);
    cause.share = explanation.log_evidence > 0.0
                      ? std::clamp(cause.log_evidence_gain / explanation.log_evidence, 0.0, 1.0)
                      : 0.0;
    explanation.causes.push_back(std::move(cause));
  }
  return explanation;
}

std::vector<ErrorLevel> levels_of(const ModesProblem& problem, const ModesFit& fit) {
  std::vector<ErrorLevel> levels;
  const auto& prior = problem.prior();
  for (std::size_t c = 0; c < kErrorClasses; ++c) {
    const auto i = static_cast<Index>(c);
    if (fit.determined(i) <= 0.0) continue;
    levels.push_back({std::string(name(static_cast<ErrorClass>(c))), fit.levels(i), prior.usual(i),
                      prior.at_most(i), fit.determined(i)});
  }
  return levels;
}

bool at_a_limit(const ModesProblem& problem, const ModesFit& fit) {
  for (std::size_t c = 0; c < kErrorClasses; ++c) {
    if (is_at_limit(problem, fit, static_cast<ErrorClass>(c))) return true;
  }
  return false;
}

// Frequencies that are left so far off are those of no model of this structure, whatever else fits.
bool has_poor_frequencies(const ModesProblem& problem, const ModesFit& fit) {
  const auto frequency = frequency_errors(fit);
  return problem.prior().width > 0.0 && frequency.level > kConstants.real_frequency &&
         frequency.determined >= kConstants.errors_of_a_level;
}

bool has_few_partners(const ModesFit& fit) {
  const auto all = std::ssize(fit.matching.model);
  const auto paired = all - count_alone(fit.matching);
  return static_cast<double>(paired) < kConstants.few_partners * static_cast<double>(all);
}

Verdict verdict_of(const ModesProblem& problem, const ModesFound& found, const Weighed& all,
                   const std::vector<Explanation>& explanations, double least_evidence) {
  const auto& best = explanations.front();
  const auto& fit = *all.fits.front();
  if (at_a_limit(problem, fit) || has_few_partners(fit)) return Verdict::unexplained;
  if (!fit.causes.empty() && has_poor_frequencies(problem, fit)) return Verdict::unexplained;
  // That a mode or a channel is not to be believed needs the evidence and the probability of a
  // cause, too.
  if (fit.disturbed.what != Disturbed::What::nothing) {
    const bool sure = best.log_evidence >= least_evidence && best.probability >= kConstants.sure;
    return sure ? Verdict::unexplained : Verdict::no_discrepancy;
  }
  if (best.causes.empty()) return Verdict::no_discrepancy;
  if (is_another_body(best)) return Verdict::unexplained;
  if (!is_supported(found, fit, least_evidence)) return Verdict::ambiguous;
  const auto is_sure = [&](const Cause& cause) {
    return cause.probability >= kConstants.sure && cause.log_evidence_gain >= least_evidence;
  };
  if (std::ranges::none_of(best.causes, is_sure)) return Verdict::ambiguous;
  const bool is_all = std::ranges::all_of(best.causes, is_sure) &&
                      !is_part_of_more(problem.structure(), found, fit, least_evidence);
  return is_all ? Verdict::named : Verdict::partial;
}

// Causes beside what no cause explains.
void limit_doubtful(std::vector<Explanation>& explanations) {
  for (auto& explanation : explanations) {
    for (auto& cause : explanation.causes) {
      cause.probability = std::min(cause.probability, kConstants.beside_unnamed);
    }
  }
}

std::optional<Superclass> superclass_of(const ModesProblem& problem, const ModesFit& fit) {
  using What = Disturbed::What;
  if (fit.disturbed.what == What::nothing) return std::nullopt;
  const auto& measured = problem.measured();
  const auto i = fit.disturbed.index;
  Superclass result;
  if (fit.disturbed.what == What::mode) {
    result.name = mode_name(measured, i);
  } else {
    const bool is_sensor = fit.disturbed.what == What::sensor;
    result.name = is_sensor ? "sensor" : "actuator";
    result.channel = (is_sensor ? measured.outputs : measured.inputs)[at(i)];
  }
  // Modes have no misfit over frequency of which this were a part.
  result.explained = std::numeric_limits<double>::quiet_NaN();
  return result;
}

// MAC of a measured mode with its partner; 1 where no shape was measured.
double mac_of(const ModesProblem& problem, const ModesFit& fit, std::size_t i) {
  const Index k = fit.matching.model[i];
  return k < 0 ? std::numeric_limits<double>::quiet_NaN()
               : partner(problem.measured(), fit.model, problem.units(), static_cast<Index>(i),
                         fit.matching.span[i])
                     .mac();
}

double hz_of(const ModesFit& fit, std::size_t i) {
  const Index k = fit.matching.model[i];
  return k < 0 ? std::numeric_limits<double>::quiet_NaN() : fit.model.frequency_hz(k);
}

// The study with its own constants, beside the structure that was calibrated.
ModesFit as_stated(const ModesProblem& problem, const ModesFit& calibrated) {
  if (problem.constants().empty()) return calibrated;
  ModesFit stated;
  if (auto model = problem.modes(problem.with(stated), false)) {
    stated.model = std::move(*model);
    stated.matching = problem.matchings(stated.model).front();
    return stated;
  }
  return calibrated;
}

std::vector<ModeTold> modes_of(const ModesProblem& problem, const ModesFit& before,
                               const ModesFit& after) {
  std::vector<ModeTold> all;
  for (std::size_t i = 0; i < before.matching.model.size(); ++i) {
    all.push_back({problem.measured().frequency_hz(static_cast<Index>(i)), hz_of(before, i),
                   hz_of(after, i), mac_of(problem, before, i), mac_of(problem, after, i)});
  }
  return all;
}

// What to measure next, best first.
std::vector<Proposal> proposals_of(const ModesProblem& problem, const Weighed& all,
                                   const MeasurementCosts& costs) {
  std::vector<WeighedFit> first;
  for (std::size_t i = 0; i < std::min(all.fits.size(), kConstants.next_rivals); ++i) {
    first.push_back({all.fits[i], all.probability[i]});
  }
  return next_measurements(problem, first, costs);
}

std::string next_in_words(const Explanation& told, const ModesFit& best, Verdict verdict,
                          const std::vector<Proposal>& proposals) {
  if (has_few_partners(best)) {
    return "make sure that the study and the modes are of one structure: most measured modes have "
           "no partner";
  }
  if (is_another_body(told)) return another_body_in_words();
  if (!proposals.empty()) return in_words(proposals.front());
  if (verdict == Verdict::named) {
    return "nothing is left to tell apart: mend what is named, in the study or on the structure, "
           "and compare again";
  }
  return "nothing here tells the explanations apart: no sensor, no known mass, no weighing, no "
         "dimension";
}

}  // namespace

Diagnosis answer(const ModesProblem& problem, const ModesFound& found,
                 const DiagnosisOptions& options) {
  Weighed all = weighed(problem.structure(), found, options.rival_within);
  put_supported_first(problem.structure(), found, options.least_evidence, all);
  std::vector<Explanation> explanations;
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    explanations.push_back(explanation_of(problem, found, all, i));
  }
  const auto& best = *all.fits.front();
  Diagnosis diagnosis;
  diagnosis.verdict = verdict_of(problem, found, all, explanations, options.least_evidence);
  if (diagnosis.verdict == Verdict::unexplained) limit_doubtful(explanations);
  diagnosis.best = explanations.front();
  diagnosis.rivals.assign(explanations.begin() + 1, explanations.end());
  if (diagnosis.verdict != Verdict::no_discrepancy) {
    diagnosis.superclass = superclass_of(problem, best);
  }
  if (problem.prior().width > 0.0) {
    diagnosis.levels_before = levels_of(problem, found.nothing);
    diagnosis.levels_after = levels_of(problem, best);
  }
  diagnosis.modes = modes_of(problem, as_stated(problem, found.nothing), best);
  if (diagnosis.verdict != Verdict::no_discrepancy) {
    diagnosis.proposals = proposals_of(problem, all, options.costs);
    diagnosis.measure_next =
        next_in_words(diagnosis.best, best, diagnosis.verdict, diagnosis.proposals);
  }
  tell_constants(problem, best, diagnosis);
  auto order = note_on_order(diagnosis, options.rival_within, found.evidence_power);
  if (!order.empty()) diagnosis.notes.push_back(std::move(order));
  return diagnosis;
}

bool is_at_limit(const ModesProblem& problem, const ModesFit& fit, ErrorClass of) {
  const auto i = static_cast<Index>(of);
  return problem.prior().width > 0.0 && fit.determined(i) > 0.5 &&
         fit.levels(i) >= kConstants.at_the_limit * problem.prior().at_most(i);
}

}  // namespace chladni::diagnosis
