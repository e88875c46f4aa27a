#include "diagnosis/verdict/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/verdict/cause_of.h"
#include "diagnosis/verdict/counterparts.h"
#include "diagnosis/verdict/told_deviations.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

Explanation explanation_of(const Problem& problem, const Found& found, const Fit& fit) {
  Explanation explanation;
  Index first = 0;
  for (std::size_t c = 0; c < fit.causes.size(); ++c) {
    const Index count = fit.causes[c].x.size();
    explanation.causes.push_back(cause_of(problem.structure, fit.causes[c],
                                          fit.covariance.diagonal().segment(first, count)));
    first += count;
  }
  explanation.log_evidence = fit.log_evidence - found.nothing.log_evidence;
  explanation.promise = fit.evidence_at_best() - fit.log_evidence;
  explanation.excess = fit.excess(problem.observed.number_count());
  explanation.strained = fit.strained();
  return explanation;
}

bool same_name(const Cause& a, const Cause& b) {
  return a.effect == b.effect && a.channels == b.channels && a.option == b.option;
}

// True if `cause` is a simpler case of `more`.
bool is_simpler(const Cause& cause, const Cause& more) {
  return std::ranges::any_of(effect(more.effect).simpler, [&](const Simpler& simpler) {
    return simpler.effect->name == cause.effect;
  });
}

// True if `simple` has the same or simpler causes, or if `other` has all its causes and more.
bool nested(const Explanation& simple, const Explanation& other) {
  if (simple.causes.size() > other.causes.size()) return false;
  const auto found = counterparts(simple.causes, other.causes, same_name, is_simpler);
  if (!found || simple.causes.size() == other.causes.size()) return found.has_value();
  return std::ranges::equal(simple.causes, *found,
                            [](const Cause& a, const Cause* b) { return same_name(a, *b); });
}

// Part of the general effect's gain that the simpler effect may leave.
double share_left_to(const Effect& simpler, const Effect& general) {
  double share = std::pow(simpler.error, 2);
  for (const auto& pair : general.simpler) {
    if (pair.effect == &simpler) share = std::max(share, pair.share);
  }
  return share;
}

// ln of evidence that simpler effects may leave, when they replace some of equally many causes;
// none if no effect is simpler.
std::optional<double> cost_of_simplicity(const Explanation& simple, const Explanation& other) {
  const auto found = counterparts(simple.causes, other.causes, same_name, is_simpler);
  if (!found || simple.causes.size() != other.causes.size()) return std::nullopt;
  std::optional<double> cost;
  for (std::size_t c = 0; c < simple.causes.size(); ++c) {
    const Cause& instead = *(*found)[c];
    if (simple.causes[c].effect == instead.effect) continue;
    const double share = share_left_to(effect(simple.causes[c].effect), effect(instead.effect));
    cost = cost.value_or(0.0) + share * std::max(instead.log_evidence_gain, 0.0);
  }
  return cost;
}

// For each cause: the evidence lost without it, and the share of the excess that it removes.
void weigh_causes(const Problem& problem, const Found& found, const Fit& fit,
                  Explanation& explanation) {
  const double n = problem.observed.number_count();
  const double excess = std::max(found.nothing.strained() - n, 1e-9);
  explanation.error_excess = 0.0;
  for (std::size_t c = 0; c < explanation.causes.size(); ++c) {
    const Fit less = without(problem, fit, c, found.nothing);
    explanation.causes[c].log_evidence_gain = fit.log_evidence - less.evidence_at_best();
    explanation.causes[c].share = std::clamp((less.strained() - fit.strained()) / excess, 0.0, 1.0);
    const double error = error_of(problem, fit.causes[c]);
    explanation.error_excess +=
        excess_of(error * error * std::max(explanation.causes[c].log_evidence_gain, 0.0), n);
  }
}

// Share of the initial penalised misfit that is left. The initial misfit counts at most as that of
// a zero response: an explanation that is only nearer to the data than a simulation of another
// structure explains little.
double share_left(const Problem& problem, const Found& found, const Explanation& explanation) {
  const double n = problem.observed.number_count();
  const double was = std::min(found.nothing.strained(), problem.observed.power());
  return std::max(explanation.strained - n, 0.0) / std::max(was - n, 1e-9);
}

// The excess z that neither noise nor errors of the causes explain. Penalised misfit is used,
// because its sum is χ² with N degrees of freedom if the tolerances are right.
double unexplained(const Problem& problem, const Explanation& explanation) {
  const double n = problem.observed.number_count();
  double sizes = 0.0;
  for (const auto& cause : explanation.causes)
    sizes += static_cast<double>(cause.parameters.size());
  const double left = (explanation.strained - n + sizes) / std::sqrt(2.0 * n);
  return std::max(left - explanation.error_excess, 0.0);
}

// Probability that causes and noise are all there is; then z is normal. An effect outside the
// catalogue leaves any z up to a limit. Each further cause makes the explanation less likely. A
// cause near another one of its kind makes it less likely by
// the probability of this nearness by chance, because both may be one extended cause.
double all_there_is(const Problem& problem, const Explanation& explanation) {
  const double other = kConstants.outside_prior / kConstants.outside_excess;
  const double further = std::max(0.0, static_cast<double>(explanation.causes.size()) - 1.0);
  const double prior = kConstants.one_cause_prior *
                       std::pow(kConstants.further_cause_prior, further) *
                       by_chance_so_near(problem.structure, explanation.causes);
  const double z = unexplained(problem, explanation);
  const double noise = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
  return prior * noise / (prior * noise + other);
}

// Probability that a cause is present although an unnamed one is too: its gain against the rest.
double beside_unnamed(const Cause& cause, double left_share, double left) {
  const double gain = cause.log_evidence_gain;
  const double against = kConstants.weight_of_unnamed * left;
  const double outweighs = gain > 0.0 ? gain / (gain + against) : 1.0;  // 0: was not weighed
  return kConstants.beside_unnamed * (1.0 - left_share) * outweighs;
}

void share_probability(const Problem& problem, const Found& found,
                       std::vector<Explanation>& explanations) {
  const double n = problem.observed.number_count();
  const double divided_by = temper(problem, found);
  const double best = explanations.front().log_evidence;
  double sum = 0.0;
  for (auto& explanation : explanations) {
    // A rival that has not converged may still become better.
    const double promise = &explanation == &explanations.front() ? 0.0 : explanation.promise;
    explanation.probability =
        std::exp(std::max(-700.0, (explanation.log_evidence + promise - best) / divided_by));
    sum += explanation.probability;
  }
  for (auto& explanation : explanations) {
    explanation.probability /= sum;
    const double share =
        std::min(share_left(problem, found, explanation) / kConstants.left_at_most, 1.0);
    const double left = lost_by(unexplained(problem, explanation), n);
    const double whole = all_there_is(problem, explanation);
    for (std::size_t c = 0; c < explanation.causes.size(); ++c) {
      const double beside = beside_unnamed(explanation.causes[c], share, left) *
                            of_its_own(problem.structure, explanation.causes, c);
      explanation.causes[c].probability =
          explanation.probability * (whole + (1.0 - whole) * beside);
    }
  }
}

// How much less `simple` explains, in ln: the smaller of the differences in evidence and in half
// the penalised misfit. So the width of a prior alone is no reason to prefer one of equal size.
double behind(const Explanation& simple, const Explanation& other) {
  return std::min(other.log_evidence - simple.log_evidence,
                  0.5 * (simple.strained - other.strained));
}

// True if `simple` explains as well as `other`: with fewer causes, or with simpler ones.
bool stands_for(const Explanation& simple, const Explanation& other, double equal) {
  if (!nested(simple, other)) return false;
  if (simple.causes.size() < other.causes.size()) return behind(simple, other) <= equal;
  const auto cost = cost_of_simplicity(simple, other);
  return cost && behind(simple, other) <= std::max(equal, *cost);
}

// Puts a simpler explanation first. The misfit that it leaves is an error of its own: it is no
// evidence against it, and no reason to look for more causes.
void put_first(const Problem& problem, const Found& found, std::size_t which,
               std::vector<Explanation>& explanations) {
  const double evidence = explanations.front().log_evidence;
  const double left = std::max(behind(explanations[which], explanations.front()), 0.0);
  const auto at = static_cast<std::ptrdiff_t>(which);
  std::rotate(explanations.begin(), explanations.begin() + at, explanations.begin() + at + 1);
  auto& front = explanations.front();
  weigh_causes(problem, found, found.fits[front.fit], front);
  front.error_excess += excess_of(left, problem.observed.number_count());
  front.log_evidence = std::max(front.log_evidence, evidence);
}

// Shorter side [m] of a rectangle of the same area and slenderness as the surface.
double shorter_side(const Structure& structure) {
  const double u =
      prior_width(structure, {.name = "u", .unit = "m", .role = Parameter::Role::place_u});
  const double v =
      prior_width(structure, {.name = "v", .unit = "m", .role = Parameter::Role::place_v});
  return std::sqrt(2.0 * std::numbers::pi) * std::min(u, v);
}

// Area [m²] of a disc within a strip, about the middle of the strip.
double area_around(double radius, double strip) {
  const double half = 0.5 * strip;
  if (radius <= half) return std::numbers::pi * radius * radius;
  return 2.0 * (half * std::sqrt(radius * radius - half * half) +
                radius * radius * std::asin(half / radius));
}

// Share of the surface that is as near to one cause as the other; 1 if they are not of one kind.
double share_as_near(const Structure& structure, const Cause& cause, const Cause& other) {
  if (!cause.place || !other.place || cause.effect != other.effect) return 1.0;
  const double around = area_around((*cause.place - *other.place).norm(), shorter_side(structure));
  return std::min(1.0, around / structure.surface.area.sum());
}

double half_mean(double sum, double count) { return count > 0.0 ? 0.5 * sum / count : 0.0; }

// Residual in equal parts of the lines.
void add_bands(const Observed& observed, const Eigen::ArrayXXd& power,
               const Eigen::ArrayXXd& measured, Residue& left) {
  const Index bands = kConstants.bands;
  left.band_edges_hz.resize(bands + 1);
  left.per_band.resize(bands);
  const Index lines = observed.line_count();
  for (Index b = 0; b <= bands; ++b) {
    left.band_edges_hz(b) =
        observed.omega(std::min(lines - 1, lines * b / bands)) / (2.0 * std::numbers::pi);
  }
  for (Index b = 0; b < bands; ++b) {
    const Index first = lines * b / bands;
    const Index count = lines * (b + 1) / bands - first;
    left.per_band(b) =
        half_mean(power.middleRows(first, count).sum(), measured.middleRows(first, count).sum());
  }
}

}  // namespace

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, 5> kNames{"no_discrepancy", "named", "ambiguous",
                                                   "partial", "unexplained"};
  return kNames[static_cast<std::size_t>(verdict)];
}

double by_chance_so_near(const Structure& structure, const std::vector<Cause>& causes) {
  double chance = 1.0;
  for (std::size_t c = 1; c < causes.size(); ++c) {
    double share = 1.0;
    for (std::size_t before = 0; before < c; ++before) {
      share = std::min(share, share_as_near(structure, causes[c], causes[before]));
    }
    chance *= share;
  }
  return chance;
}

double of_its_own(const Structure& structure, const std::vector<Cause>& causes, std::size_t which) {
  double share = 1.0;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    if (c != which) share = std::min(share, share_as_near(structure, causes[which], causes[c]));
  }
  return share < 1.0 ? share / (share + kConstants.extended_prior) : 1.0;
}

// A residual above noise is a cause that nobody named. It may also explain the other data.
double temper(const Problem& problem, const Found& found) {
  return std::max(1.0, found.fits.front().chi_square / problem.observed.number_count());
}

std::vector<Explanation> explanations(const Problem& problem, const Found& found, double equal) {
  std::vector<Explanation> explanations;
  for (std::size_t n = 0; n < found.fits.size(); ++n) {
    const bool again = std::ranges::any_of(explanations, [&](const Explanation& other) {
      return alike(problem.structure, found.fits[other.fit], found.fits[n]);
    });
    if (again) continue;
    explanations.push_back(explanation_of(problem, found, found.fits[n]));
    explanations.back().fit = n;
  }
  weigh_causes(problem, found, found.fits[explanations.front().fit], explanations.front());
  for (std::size_t n = 1; n < explanations.size(); ++n) {
    if (stands_for(explanations[n], explanations.front(), equal)) {
      put_first(problem, found, n, explanations);
    }
  }
  std::erase_if(explanations, [&](const Explanation& other) {
    return &other != &explanations.front() && nested(explanations.front(), other);
  });
  widen_deviations(problem, found.fits[explanations.front().fit], explanations.front());
  share_probability(problem, found, explanations);
  return explanations;
}

Verdict judged(const Problem& problem, const Found& found,
               const std::vector<Explanation>& explanations, const DiagnosisOptions& options) {
  const auto& best = explanations.front();
  const bool explained = all_there_is(problem, best) > kConstants.believed;
  if (best.causes.empty()) return explained ? Verdict::no_discrepancy : Verdict::unexplained;
  if (!explained) {
    const double left = share_left(problem, found, best);
    return left < kConstants.left_at_most ? Verdict::partial : Verdict::unexplained;
  }
  const bool rivals = std::ranges::any_of(
      explanations.begin() + 1, explanations.end(), [&](const Explanation& other) {
        return best.log_evidence - (other.log_evidence + other.promise) < options.rival_within;
      });
  return rivals ? Verdict::ambiguous : Verdict::named;
}

Residue residue(const Problem& problem, const Fit& fit) {
  const auto& observed = problem.observed;
  const State state = state_of(problem, fit.causes, fit.eta);
  const Eigen::MatrixXcd whitened = (observed.value - responses(state, observed.omega))
                                        .cwiseProduct(observed.weight.cast<std::complex<double>>());
  const Eigen::ArrayXXd power = whitened.cwiseAbs2();
  const Eigen::ArrayXXd measured = (observed.weight.array() > 0.0).cast<double>();
  // Mean over every `stride`-th response, from `first` on.
  const auto over = [&](Index first, Index stride, Index count) {
    const auto columns = Eigen::seqN(first, count, stride);
    return half_mean(power(Eigen::all, columns).sum(), measured(Eigen::all, columns).sum());
  };
  Residue left;
  left.per_output.resize(observed.outputs);
  left.per_input.resize(observed.inputs);
  for (Index i = 0; i < observed.outputs; ++i) {
    left.per_output(i) = over(i, observed.outputs, observed.inputs);
  }
  for (Index j = 0; j < observed.inputs; ++j) {
    left.per_input(j) = over(j * observed.outputs, 1, observed.outputs);
  }
  add_bands(observed, power, measured, left);
  const Index lines = observed.line_count();
  const double lagged = whitened.topRows(lines - 1)
                            .conjugate()
                            .cwiseProduct(whitened.bottomRows(lines - 1))
                            .real()
                            .sum();
  left.lag_one = lagged / std::max(power.sum(), 1e-300);
  return left;
}

}  // namespace chladni::diagnosis
