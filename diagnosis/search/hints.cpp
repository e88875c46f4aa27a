#include "diagnosis/search/hints.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "base/index.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/probe.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The effect of the probe at the size that the score gives; none if this size is negative.
std::optional<Supposed> sized(const Effect& effect, const Probe& probe, double step) {
  Supposed cause{&effect, probe.option, probe.x};
  auto& x = cause.x(probe.size);
  if (probe.nothing == Nothing::zero) {
    x = step;
    return cause;
  }
  // The slope of a strength is that of its logarithm. The step is the strength relative to the
  // probe's.
  const double ratio = probe.sign() * step;
  if (!(ratio > 0.0)) return std::nullopt;
  x += probe.sign() * std::log(ratio);
  return cause;
}

// ln of Occam's factor for the size and for the choice; the place is left out.
double occam(const Structure& structure, const Effect& effect, const Probe& probe, double step,
             double known) {
  const auto parameters = effect.parameters(structure);
  const double width = parameters[at(probe.size)].width;
  // For a strength, the slope of its logarithm is proportional to it.
  const double per_width = width * (probe.nothing == Nothing::zero ? 1.0 : std::abs(step));
  return 0.5 * std::log1p(per_width * per_width * known) +
         std::log(static_cast<double>(effect.options(structure)));
}

std::vector<Hint> hints_of(const Probing& probing, const Information& information,
                           const VectorXd& left, const Effect& effect, const HintLimits& limits) {
  const auto& structure = probing.problem().structure;
  const auto probes = probing.probes(effect, kConstants.places_of_score);
  if (probes.empty()) return {};
  const auto [score, known] = information.scored(probing.size_columns(effect, probes), left);
  std::vector<Hint> best;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const auto i = static_cast<Index>(n);
    if (!(known(i) > 0.0)) continue;
    const double step = score(i) / known(i);
    const double evidence = 0.5 * limits.times * step * score(i) -
                            occam(structure, effect, probes[n], step, limits.times * known(i));
    auto cause = sized(effect, probes[n], step);
    if (!cause || !std::isfinite(log_prior(*cause, structure))) continue;
    const double lost = place_of(*cause, structure) ? kConstants.lost_between_places : 0.0;
    if (evidence < limits.least_evidence - lost) continue;
    const auto same = std::ranges::find_if(
        best, [&](const Hint& other) { return other.cause.option == cause->option; });
    if (same == best.end()) {
      best.push_back({*std::move(cause), evidence});
    } else if (evidence > same->log_evidence) {
      *same = {*std::move(cause), evidence};
    }
  }
  return best;
}

}  // namespace

std::vector<Hint> hints(const Problem& problem, const Fit& about,
                        const std::vector<const Effect*>& catalogue, const HintLimits& limits) {
  const Probing probing(problem, state_of(problem, about.causes, about.eta));
  const Information information(problem, about);
  const VectorXd left = residual(problem.observed, probing.now().value);
  std::vector<std::vector<Hint>> each(catalogue.size());
  const dense::OneBlasThread one_thread;
  parallel_tasks(each.size(), [&](std::size_t n) {
    throw_if_interrupted();
    each[n] = hints_of(probing, information, left, *catalogue[n], limits);
  });
  std::vector<Hint> sorted;
  for (auto& of_effect : each) std::ranges::move(of_effect, std::back_inserter(sorted));
  std::ranges::stable_sort(sorted, std::greater{}, &Hint::log_evidence);
  return sorted;
}

}  // namespace chladni::diagnosis
