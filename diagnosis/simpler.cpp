#include "diagnosis/simpler.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace chladni::diagnosis {
namespace {

// What errors of the causes may have cost: ln of a probability.
double cost_of_errors(const Structure& structure, const Fit& nothing, const Fit& fit) {
  double error2 = 0.0;
  for (const auto& cause : fit.causes) error2 += std::pow(error_of(cause, structure), 2);
  return error2 * std::max(nothing.objective - fit.objective, 0.0);
}

}  // namespace

void keep(std::vector<Fit>& fits, Fit fit, std::ptrdiff_t fixed) {
  const auto place = std::find_if(fits.begin() + fixed, fits.end(), [&](const Fit& other) {
    return other.log_evidence < fit.log_evidence;
  });
  fits.insert(place, std::move(fit));
}

Fit without(const Problem& problem, const Fit& fit, std::size_t which, const Fit& nothing) {
  if (!fit.less.empty()) return fit.less[which];
  Fit start = fit;
  start.causes.erase(start.causes.begin() + static_cast<std::ptrdiff_t>(which));
  return start.causes.empty() ? nothing : fitted(problem, start);
}

bool is_sure(const Problem& problem, const SearchLimits& limits, const Fit& nothing,
             const Fit& less, const Fit& more) {
  return more.log_evidence - less.log_evidence >=
         std::max(limits.sure_evidence, cost_of_errors(problem.structure, nothing, less));
}

Fit pruned(const Problem& problem, const Fit& whole, const Fit& nothing,
           const SearchLimits& limits) {
  Fit best = whole;
  std::vector<Fit> kept;
  for (std::size_t c = 0; c < best.causes.size();) {
    Fit less = without(problem, best, c, nothing);
    // Stretched tolerances count as misfit. What is small beside a large cause still counts where
    // the data want it, or where it is no matter of luck.
    const double gain = best.log_evidence - less.log_evidence;
    const bool material = less.objective - best.objective >=
                          limits.least_share * (nothing.objective - best.objective);
    const double n = problem.observed.number_count();
    const double left =
        less.excess(n) - excess_of(cost_of_errors(problem.structure, nothing, less), n);
    const bool wanted = left >= limits.least_excess;
    const bool sure = is_sure(problem, limits, nothing, less, best);
    if (gain >= limits.least_evidence && (material || wanted || sure)) {
      kept.push_back(std::move(less));
      ++c;
    } else {
      best = std::move(less);
      kept.clear();
      c = 0;
    }
  }
  best.less = std::move(kept);
  return best;
}

void add_simpler(const Problem& problem, Found& found) {
  const Fit best = found.fits.front();
  for (std::size_t c = 0; c < best.causes.size(); ++c) {
    auto simpler = simplified(best.causes[c], problem.structure);
    if (!simpler || !std::isfinite(log_prior(*simpler, problem.structure))) continue;
    Fit start = best;
    start.causes[c] = *std::move(simpler);
    FitLimits limits;
    limits.bar = best.objective + kOccamMargin +
                 2.0 * cost_of_errors(problem.structure, found.nothing, best);
    keep(found.fits, fitted(problem, start, limits), 1);
  }
}

}  // namespace chladni::diagnosis
