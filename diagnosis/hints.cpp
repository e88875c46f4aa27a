#include "diagnosis/hints.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "diagnosis/information.h"
#include "diagnosis/probe.h"
#include "priors/dense.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPlaces = 49;

// The probe's effect at the size that the score asks for; none where it asks for less than nothing.
std::optional<Supposed> sized(const Effect& effect, const Probe& probe, double step) {
  Supposed cause{&effect, probe.option, probe.x};
  auto& x = cause.x(probe.size);
  if (probe.nothing == Nothing::zero) {
    x = step;
    return cause;
  }
  // Of a strength the slope is that of its logarithm: the step is the strength over the probe's.
  const double ratio = probe.nothing == Nothing::minus_infinity ? step : -step;
  if (!(ratio > 0.0)) return std::nullopt;
  x += probe.nothing == Nothing::minus_infinity ? std::log(ratio) : -std::log(ratio);
  return cause;
}

std::vector<Hint> hints_of(const Probing& probing, const Information& information,
                           const VectorXd& left, const Effect& effect, double least) {
  const auto& structure = probing.problem().structure;
  const auto probes = probing.probes(effect, kPlaces);
  if (probes.empty()) return {};
  const MatrixXd slopes = probing.size_columns(effect, probes);
  const VectorXd known = information.of(slopes).diagonal();
  const VectorXd score = slopes.transpose() * left;
  std::vector<Hint> best;
  for (std::size_t n = 0; n < probes.size(); ++n) {
    const auto i = static_cast<Index>(n);
    const double fall = known(i) > 0.0 ? score(i) * score(i) / known(i) : 0.0;
    if (!(fall > least)) continue;
    auto cause = sized(effect, probes[n], score(i) / known(i));
    if (!cause || !std::isfinite(log_prior(*cause, structure))) continue;
    const auto same = std::ranges::find_if(
        best, [&](const Hint& other) { return other.cause.option == cause->option; });
    if (same == best.end()) {
      best.push_back({*std::move(cause), fall});
    } else if (fall > same->fall) {
      *same = {*std::move(cause), fall};
    }
  }
  return best;
}

}  // namespace

std::vector<Hint> hints(const Problem& problem, const Fit& about,
                        const std::vector<const Effect*>& catalogue, double least) {
  const Probing probing(problem, state_of(problem, about.causes, about.eta));
  const Information information(problem, about);
  const VectorXd left = residual(problem.observed, probing.now().value);
  std::vector<std::vector<Hint>> each(catalogue.size());
  const priors::dense::OneThread one;
  parallel_tasks(each.size(), [&](std::size_t n) {
    each[n] = hints_of(probing, information, left, *catalogue[n], least);
  });
  std::vector<Hint> all;
  for (auto& of_effect : each) std::ranges::move(of_effect, std::back_inserter(all));
  std::ranges::stable_sort(all, std::greater{}, &Hint::fall);
  return all;
}

}  // namespace chladni::diagnosis
