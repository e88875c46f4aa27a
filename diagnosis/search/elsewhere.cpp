#include "diagnosis/search/elsewhere.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "diagnosis/fit/information.h"
#include "diagnosis/search/probe.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kAsMuch = 0.8;  // part of what its own place promises, to first order

// The cause in another place, and the evidence that it promises there.
struct Promise {
  Supposed cause;
  Vector2d place;
  double evidence = 0.0;
};

// Probes of the cause's size at some places, the last one at its own, with its other numbers kept.
std::vector<Probe> probes_of(const Probing& probing, const Supposed& cause) {
  const auto parameters = cause.effect->parameters(probing.problem().structure);
  auto all = probing.probes(*cause.effect, kPlacesOfScore);
  std::erase_if(all, [&](const Probe& probe) { return probe.option != cause.option; });
  if (all.empty()) return all;
  all.resize(std::min<std::size_t>(all.size(), kPlacesOfScore), all.front());
  all.push_back(all.front());
  for (Index i = 0; i < cause.x.size(); ++i) {
    if (i == all.front().size) continue;
    all.back().x(i) = cause.x(i);
    if (parameters[static_cast<std::size_t>(i)].is_place()) continue;
    for (auto& probe : all) probe.x(i) = cause.x(i);
  }
  return all;
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
  std::vector<Promise> all;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const auto i = static_cast<Index>(n);
    Supposed there{cause.effect, cause.option, probes[n].x};
    there.x(probes[n].size) = cause.x(probes[n].size);
    const auto place = place_of(there, problem.structure);
    const bool possible = known(i) > 0.0 && is_possible(probes[n], score(i));
    const double evidence = possible ? 0.5 * score(i) * score(i) / known(i) : 0.0;
    all.push_back({std::move(there), *place, evidence});
  }
  return all;
}

}  // namespace

std::vector<Supposed> elsewhere(const Problem& problem, const Fit& without, const Supposed& cause) {
  constexpr std::size_t kMost = 2;
  if (!place_of(cause, problem.structure)) return {};
  auto all = promises(problem, without, cause);
  if (all.empty()) return {};
  const Promise own = all.back();
  all.pop_back();
  std::ranges::stable_sort(all, std::greater{}, &Promise::evidence);
  const double apart = Surface::kOnePeak * problem.structure.surface.size();
  std::vector<Vector2d> fields{own.place};
  std::vector<Supposed> found;
  for (auto& one : all) {
    if (found.size() == kMost || one.evidence < kAsMuch * own.evidence - kLostBetweenPlaces) break;
    const auto near = [&](const Vector2d& other) { return (one.place - other).norm() < apart; };
    if (std::ranges::any_of(fields, near)) continue;
    fields.push_back(one.place);
    found.push_back(std::move(one.cause));
  }
  return found;
}

}  // namespace chladni::diagnosis
