#include "diagnosis/modes/specimens/specimens_told.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/specimens/specimen_constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;
using Kind = CalibratedConstant::Kind;

constexpr std::size_t kMostRivals = 12;

// Everything that the parts of the answer look at.
struct View {
  const std::vector<Specimen>& specimens;
  const SpecimenModels& models;
  const Series& series;
  const JointModel& model;
  const WeighedFits& weighed;

  [[nodiscard]] const JointFit& best() const { return weighed.fits.front(); }
  [[nodiscard]] bool is_fitted(const JointFit& fit) const { return fit.inverse.size() > 0; }
};

// The entry under a hypothesis in which it is wrong.
OddEntry odd_entry(const View& view, const JointFit& fit, Index which) {
  const auto& one = view.series.entries[at(which)];
  OddEntry odd;
  odd.specimen = view.series.bodies[at(one.body)];
  odd.key = one.stated.name;
  odd.effect = one.stated.effect;
  odd.unit = one.stated.unit;
  odd.of_study = one.stated.value;
  odd.probability = view.weighed.probability_of(which);
  const auto alone = std::ranges::find_if(view.weighed.fits, [&](const JointFit& other) {
    return other.supposed.entries == std::vector<Index>{which};
  });
  if (alone != view.weighed.fits.end()) {
    odd.log_evidence = alone->log_evidence - view.weighed.none().log_evidence;
  }
  const JointFit refitted = view.is_fitted(fit)
                                ? JointFit{}
                                : view.model.fitted(fit.supposed, view.weighed.none().ln_levels);
  const Vector2d off = view.model.entry(view.is_fitted(fit) ? fit : refitted, at(which));
  odd.value = one.stated.value * std::exp(off(0));
  odd.std = odd.value * std::sqrt(std::max(off(1), 0.0));
  return odd;
}

SpecimensExplanation explanation(const View& view, std::size_t i) {
  const auto& fit = view.weighed.fits[i];
  SpecimensExplanation one;
  one.probability = view.weighed.probability[i];
  one.log_evidence = fit.log_evidence - view.weighed.none().log_evidence;
  for (const Index e : fit.supposed.entries) one.entries.push_back(odd_entry(view, fit, e));
  if (fit.supposed.unlike >= 0) {
    one.unlike = view.series.bodies[at(fit.supposed.unlike)];
    one.by_modes = fit.supposed.by_modes;
  }
  return one;
}

// All entries that may be wrong, each under the best hypothesis that has it.
std::vector<OddEntry> entries_of(const View& view) {
  std::vector<OddEntry> all;
  for (std::size_t e = 0; e < view.series.entries.size(); ++e) {
    const auto which = static_cast<Index>(e);
    const auto has_it = std::ranges::find_if(view.weighed.fits, [&](const JointFit& fit) {
      return std::ranges::find(fit.supposed.entries, which) != fit.supposed.entries.end();
    });
    if (has_it != view.weighed.fits.end()) all.push_back(odd_entry(view, *has_it, which));
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &OddEntry::probability);
  return all;
}

Verdict verdict_of(const View& view, const SpecimensExplanation& best) {
  const auto levels = view.best().ln_levels.head(2).array().exp();
  if (levels.maxCoeff() > kConstants.at_the_limit * kSpecimens.error_at_most) {
    return Verdict::unexplained;
  }
  if (!best.unlike.empty()) return Verdict::unexplained;
  if (best.entries.empty()) return Verdict::no_discrepancy;
  const auto is_sure = [](const OddEntry& one) { return one.probability >= kConstants.sure; };
  if (std::ranges::all_of(best.entries, is_sure)) return Verdict::named;
  return std::ranges::any_of(best.entries, is_sure) ? Verdict::partial : Verdict::ambiguous;
}

CalibratedNumber number(const CalibratedConstant& stated, double value_of_study,
                        const Vector2d& ln_change, double prior) {
  const double value = value_of_study * std::exp(ln_change(0));
  const double variance = std::max(ln_change(1), 0.0);
  return {stated.name,   stated.unit,
          stated.effect, value_of_study,
          value,         value * std::sqrt(variance),
          prior,         variance < kConstants.not_determined * prior * prior};
}

std::vector<CalibratedNumber> numbers_of(const View& view, Index body) {
  std::vector<CalibratedNumber> all;
  for (std::size_t c = 0; c < view.series.constants.size(); ++c) {
    const auto& one = view.series.constants[c];
    if (one.slope.col(body).isZero(0.0)) continue;
    const auto posterior = view.model.constant(view.best(), c);
    const double off = one.of_body(body);
    const Vector2d change(posterior.mean(body) - off, posterior.covariance(body, body));
    const double prior = std::hypot(one.width, view.model.spread(view.best(), c));
    all.push_back(number(one.stated, one.stated.value * std::exp(off), change, prior));
  }
  for (std::size_t e = 0; e < view.series.entries.size(); ++e) {
    const auto& one = view.series.entries[e];
    if (one.body != body) continue;
    all.push_back(number(one.stated, one.stated.value, view.model.entry(view.best(), e),
                         one.stated.deviation));
    all.back().determined = true;  // it was measured
  }
  return all;
}

// The modes of a measurement before and after, and what is left of ln f.
SpecimenTold specimen_told(const View& view, std::size_t m) {
  const auto& own = *view.models.all()[m];
  SpecimenTold one{
      view.specimens[m].name, view.specimens[m].group, view.specimens[m].same_as, {}, {}, 0.0};
  one.constants = numbers_of(view, own.body);
  ModesFit stated;
  const auto before = own.problem->modes(own.problem->with(stated), false);
  const auto pairs = before ? own.problem->matchings(*before).front() : Matching{};
  const VectorXd shared = view.model.shared_error(view.best());
  const VectorXd left = view.series.error - shared;
  double sum = 0.0;
  int count = 0;
  for (Index i = 0; i < view.series.count(); ++i) {
    const auto& row = view.series.rows[at(i)];
    if (row.measurement != static_cast<Index>(m) || row.mode < 0) continue;
    double off = left(i);
    for (std::size_t c = 0; c < view.series.constants.size(); ++c) {
      const VectorXd values = view.model.constant(view.best(), c).mean;
      off -= view.series.constants[c].slope.row(i).dot(values);
    }
    for (std::size_t e = 0; e < view.series.entries.size(); ++e) {
      off -= view.series.entries[e].slope(i) * view.model.entry(view.best(), e)(0);
    }
    const double hz = own.given.measured.frequency_hz(row.measured);
    ModeTold mode{hz, std::nan(""), hz * std::exp(-off), std::nan(""), std::nan("")};
    if (before && pairs.model[at(row.measured)] >= 0) {
      mode.before_hz = before->frequency_hz(pairs.model[at(row.measured)]);
    }
    one.modes.push_back(mode);
    sum += off * off;
    ++count;
  }
  one.scatter = count > 0 ? std::sqrt(sum / count) : 0.0;
  return one;
}

std::vector<PopulationConstant> population_of(const View& view) {
  std::vector<PopulationConstant> all;
  for (std::size_t c = 0; c < view.series.constants.size(); ++c) {
    const auto& one = view.series.constants[c];
    const Vector2d mean = view.model.mean_of(view.best(), c);
    const double value = one.stated.value * std::exp(mean(0));
    all.push_back({one.stated.name, one.stated.unit, one.stated.effect, value,
                   value * std::sqrt(std::max(mean(1), 0.0)), view.model.spread(view.best(), c),
                   view.model.within_group(view.best(), c),
                   mean(1) < kConstants.not_determined * one.width * one.width});
  }
  return all;
}

// What would be measured to check an entry.
std::string task_of(const OddEntry& odd) {
  if (odd.effect == "mass") return odd.specimen;
  const auto dot = odd.key.rfind('.');
  return fmt::format("the {} of {}", dot == std::string::npos ? odd.key : odd.key.substr(dot + 1),
                     odd.specimen);
}

// ln of the Bayes factor that an entry, measured again, is expected to bring: of what it would be
// if it were wrong against what is written.
double expected_evidence(const View& view, const OddEntry& odd) {
  const auto stated =
      std::ranges::find_if(view.series.entries, [&](const Series::Entry& one) {
        return one.stated.name == odd.key && view.series.bodies[at(one.body)] == odd.specimen;
      })->stated.deviation;
  const double again = odd.effect == "mass" ? kConstants.next_scales : kConstants.next_callipers;
  const double variance = stated * stated + again * again;
  const double off = std::log(odd.value / odd.of_study);
  const double spread = std::pow(odd.std / odd.value, 2) + again * again;
  return std::max(0.0, 0.5 * ((off * off + spread) / variance - 1.0 - std::log(spread / variance)));
}

// What the answer rests on comes first, then what is least known for its cost.
std::vector<Proposal> proposals_of(const View& view, const SpecimensExplanation& best,
                                   const std::vector<OddEntry>& entries,
                                   const MeasurementCosts& costs) {
  std::vector<std::pair<double, Proposal>> all;
  for (const auto& odd : entries) {
    const double p = odd.probability;
    if (p < 0.01) continue;
    Proposal one;
    const bool is_mass = odd.effect == "mass";
    one.what = is_mass ? Proposal::What::weighing : Proposal::What::dimension;
    one.of = task_of(odd);
    one.evidence = expected_evidence(view, odd);
    one.cost = is_mass ? costs.weighing : costs.dimension;
    const double unknown = -p * std::log(p) - (1.0 - p) * std::log1p(-std::min(p, 1.0 - 1e-12));
    const bool is_named = std::ranges::any_of(best.entries, [&](const OddEntry& other) {
      return other.specimen == odd.specimen && other.key == odd.key;
    });
    const double worth = is_named ? kSpecimens.named_first + p : unknown / one.cost;
    if (one.evidence > one.cost) all.emplace_back(worth, one);
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &std::pair<double, Proposal>::first);
  std::vector<Proposal> sorted;
  for (auto& one : all) sorted.push_back(std::move(one.second));
  return sorted;
}

std::string words_for(const OddEntry& odd) {
  return fmt::format("{} of {}", odd.key, odd.specimen);
}

void note_what_is_alike(const View& view, SpecimensDiagnosis& result) {
  if (result.best.entries.size() != 1) return;
  std::vector<std::string> rivals;
  for (const auto& odd : result.entries) {
    const bool is_best = odd.specimen == result.best.entries.front().specimen &&
                         odd.key == result.best.entries.front().key;
    if (!is_best && odd.probability >= kSpecimens.told_rival) {
      rivals.push_back(fmt::format("{} ({:.2f})", words_for(odd), odd.probability));
    }
  }
  if (rivals.empty()) return;
  result.notes.push_back(fmt::format(
      "the data do not tell {} ({:.2f}) apart from {}", words_for(result.best.entries.front()),
      result.best.entries.front().probability, fmt::join(rivals, ", ")));
  static_cast<void>(view);
}

void note_what_is_open(SpecimensDiagnosis& result) {
  std::vector<std::string> open;
  for (const auto& one : result.population) {
    if (!one.determined) open.push_back(one.name);
  }
  if (open.empty()) return;
  result.notes.push_back(
      fmt::format("the specimens do not determine {}: held at what is stated, with its deviation",
                  fmt::join(open, ", ")));
}

void note_strays(const View& view, const std::vector<Index>& strays, SpecimensDiagnosis& result) {
  for (const Index i : strays) {
    const auto& row = view.series.rows[at(i)];
    const auto m = at(row.measurement);
    result.notes.push_back(fmt::format(
        "{} of {} is not believed: no constants of these specimens have it",
        mode_name(view.models.all()[m]->given.measured, row.measured), view.specimens[m].name));
  }
}

std::string next_in_words(const SpecimensDiagnosis& result) {
  if (!result.proposals.empty()) return in_words(result.proposals.front());
  if (!result.best.unlike.empty()) {
    return fmt::format("look at {} and measure it again: {}", result.best.unlike,
                       result.best.by_modes ? "its frequencies are not those of this design"
                                            : "its constants are not those of the others");
  }
  return result.verdict == Verdict::no_discrepancy ? "" : "more modes of each specimen";
}

}  // namespace

SpecimensDiagnosis told(const std::vector<Specimen>& specimens, const SpecimenModels& models,
                        const Series& series, const JointModel& model, const WeighedFits& weighed,
                        const std::vector<Index>& strays, const DiagnosisOptions& options) {
  const View view{specimens, models, series, model, weighed};
  SpecimensDiagnosis result;
  result.best = explanation(view, 0);
  for (std::size_t i = 1; i < std::min(weighed.fits.size(), kMostRivals); ++i) {
    result.rivals.push_back(explanation(view, i));
  }
  for (std::size_t i = 0; i < weighed.fits.size(); ++i) {
    if (weighed.fits[i].supposed.is_none()) result.none = weighed.probability[i];
  }
  result.verdict = verdict_of(view, result.best);
  result.entries = entries_of(view);
  for (std::size_t m = 0; m < specimens.size(); ++m) {
    result.specimens.push_back(specimen_told(view, m));
  }
  result.population = population_of(view);
  result.shared_error = std::exp(view.best().ln_levels(0));
  result.own_error = std::exp(view.best().ln_levels(1));
  result.proposals = proposals_of(view, result.best, result.entries, options.costs);
  result.measure_next = next_in_words(result);
  result.notes = models.notes();
  note_strays(view, strays, result);
  note_what_is_alike(view, result);
  note_what_is_open(result);
  return result;
}

}  // namespace chladni::diagnosis
