#include "diagnosis/search/elsewhere.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/probe.h"
#include "diagnosis/verdict/held_out/part_misfit.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

// The cause in another place, and the evidence that it promises there.
struct Promise {
  Supposed cause;
  Vector2d place;
  double evidence = 0.0;
};

// Probes of the cause's size at some places, the last one at its own, with its other numbers kept.
std::vector<Probe> probes_of(const Probing& probing, const Supposed& cause) {
  const auto parameters = cause.effect->parameters(probing.problem().structure);
  auto probes = probing.probes(*cause.effect, kConstants.places_of_score);
  std::erase_if(probes, [&](const Probe& probe) { return probe.option != cause.option; });
  if (probes.empty()) return probes;
  probes.resize(std::min(probes.size(), at(kConstants.places_of_score)), probes.front());
  probes.push_back(probes.front());
  for (Index i = 0; i < cause.x.size(); ++i) {
    if (i == probes.front().size) continue;
    probes.back().x(i) = cause.x(i);
    if (parameters[at(i)].is_place()) continue;
    for (auto& probe : probes) probe.x(i) = cause.x(i);
  }
  return probes;
}

// A strength has one sign, because its slope is that of its logarithm.
bool is_possible(const Probe& probe, double score) {
  return probe.nothing == Nothing::zero || probe.sign() * score > 0.0;
}

std::vector<Promise> promises(const Problem& problem, const Fit& without, const Supposed& cause) {
  const Probing probing(problem, state_of(problem, without.causes, without.eta));
  const auto probes = probes_of(probing, cause);
  if (probes.empty()) return {};
  const Information information(problem, without);
  const auto left = residual(problem.observed, probing.now().value);
  const auto [score, known] = information.scored(probing.size_columns(*cause.effect, probes), left);
  std::vector<Promise> promises;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const auto i = static_cast<Index>(n);
    Supposed moved{cause.effect, cause.option, probes[n].x};
    moved.x(probes[n].size) = cause.x(probes[n].size);
    const auto place = place_of(moved, problem.structure);
    const bool possible = known(i) > 0.0 && is_possible(probes[n], score(i));
    const double evidence = possible ? 0.5 * score(i) * score(i) / known(i) : 0.0;
    promises.push_back({std::move(moved), *place, evidence});
  }
  return promises;
}

// The extents at which an effect is begun: none for an effect without one.
std::vector<Supposed> extents_of(Supposed usual, const Structure& structure) {
  const auto parameters = usual.effect->parameters(structure);
  const auto extent = std::ranges::find(parameters, Parameter::Role::extent, &Parameter::role);
  if (extent == parameters.end()) return {};
  std::vector<Supposed> all;
  for (const double widths : {0.0, -1.0, 1.0}) {
    all.push_back(usual);
    all.back().x(extent - parameters.begin()) += widths * extent->width;
  }
  return all;
}

}  // namespace

std::vector<Supposed> elsewhere(const Problem& problem, const Fit& without, const Supposed& cause) {
  if (!place_of(cause, problem.structure)) return {};
  auto promised = promises(problem, without, cause);
  if (promised.empty()) return {};
  const Promise own = promised.back();
  promised.pop_back();
  std::ranges::stable_sort(promised, std::greater{}, &Promise::evidence);
  const double apart = Surface::kOnePeak * problem.structure.surface.size();
  const double enough = kConstants.as_promising * own.evidence - kConstants.lost_between_places;
  std::vector<Vector2d> fields{own.place};
  std::vector<Supposed> found;
  for (auto& promise : promised) {
    if (found.size() == kConstants.other_places || promise.evidence < enough) break;
    const auto near = [&](const Vector2d& other) { return (promise.place - other).norm() < apart; };
    if (std::ranges::any_of(fields, near)) continue;
    fields.push_back(promise.place);
    found.push_back(std::move(promise.cause));
  }
  return found;
}

std::vector<Supposed> spread_out(const Problem& problem, const Fit& fit,
                                 const std::vector<const Effect*>& catalogue) {
  const Supposed& cause = fit.causes.back();
  std::vector<Supposed> causes = fit.causes;
  std::vector<Supposed> all;
  for (const Effect* general : catalogue) {
    const bool is_general = std::ranges::any_of(
        general->simpler, [&](const Simpler& pair) { return pair.effect == cause.effect; });
    if (!is_general || cause.option >= general->options(problem.structure)) continue;
    double least = HUGE_VAL;
    Supposed best;
    for (auto& start :
         extents_of(counterpart(cause, *general, problem.structure), problem.structure)) {
      if (!std::isfinite(log_prior(start, problem.structure))) continue;
      causes.back() = start;
      const double misfit = misfit_at(problem, causes, fit.eta);
      if (misfit < least) best = std::move(start);
      least = std::min(least, misfit);
    }
    if (least < HUGE_VAL) all.push_back(std::move(best));
  }
  return all;
}

}  // namespace chladni::diagnosis
