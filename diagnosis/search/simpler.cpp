#include "diagnosis/search/simpler.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/index.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

// True if two attachments in one place push alike on the measured lines; if not, no fit is needed.
// Also true if one of them is not exactly one attachment.
bool pushes_alike(const Problem& problem, const Supposed& a, const Supposed& b) {
  const auto hung = [&](const Supposed& cause) {
    State state = state_of(problem.structure);
    change_of(cause, problem.structure)(state);
    return state.attached;
  };
  const auto hung_a = hung(a);
  const auto hung_b = hung(b);
  if (hung_a.size() != 1 || hung_b.size() != 1) return true;
  double apart = 0.0;
  double size = 0.0;
  for (const double omega : problem.observed.omega) {
    const std::complex<double> s(0.0, omega);
    const auto force = dynamic_stiffness(hung_a.front(), s);
    apart += std::norm(force - dynamic_stiffness(hung_b.front(), s));
    size += std::norm(force);
  }
  const double part = kConstants.alike_force;
  return apart < part * part * size;
}

// ln of evidence that the simpler effect may leave of the gain of a cause.
double may_leave(const Problem& problem, const Found& found, const Fit& best, std::size_t cause,
                 const Effect& simpler) {
  double share = std::pow(error_of(problem, best.causes[cause]), 2);
  for (const auto& pair : best.causes[cause].effect->simpler) {
    if (pair.effect == &simpler) share = std::max(share, pair.share);
  }
  return share * std::max(found.nothing.objective - best.objective, 0.0);
}

}  // namespace

double cost_of_errors(const Problem& problem, const Fit& nothing, const Fit& fit) {
  double error2 = 0.0;
  for (const auto& cause : fit.causes) error2 += std::pow(error_of(problem, cause), 2);
  return error2 * std::max(nothing.objective - fit.objective, 0.0);
}

void keep(std::vector<Fit>& fits, Fit fit, std::ptrdiff_t fixed) {
  const auto place = std::find_if(fits.begin() + fixed, fits.end(), [&](const Fit& other) {
    return other.log_evidence < fit.log_evidence;
  });
  fits.insert(place, std::move(fit));
}

void keep_if_new(const Structure& structure, std::vector<Fit>& fits, Fit fit) {
  const double enough = fit.log_evidence - kConstants.exchange_gain;
  const bool there = std::ranges::any_of(fits, [&](const Fit& other) {
    return alike(structure, other, fit) && other.log_evidence > enough;
  });
  if (!there) keep(fits, std::move(fit));
}

Fit nothing_beside(const Problem& problem, const Fit& nothing, const Fit& fit) {
  if (fit.causes.empty()) return nothing;
  Fit start = nothing;
  start.eta = fit.eta;
  FitLimits limits;
  limits.bar = nothing.objective;
  Fit other = fitted(problem, start, limits);
  return other.objective < nothing.objective ? other : nothing;
}

Fit without(const Problem& problem, const Fit& fit, std::size_t which, const Fit& nothing) {
  if (!fit.less.empty()) return fit.less[which];
  Fit start = fit;
  start.causes.erase(start.causes.begin() + static_cast<std::ptrdiff_t>(which));
  if (start.causes.empty()) return nothing;
  const auto less = possible_fit(problem, start);
  if (less && less->objective <= nothing.objective) return *less;
  // The descent stopped on its way: no cause at all would leave less.
  start.eta = with_deviations(nothing, at(fit.eta.size())).eta;
  const auto again = possible_fit(problem, start);
  if (again && (!less || again->objective < less->objective)) return *again;
  return less.value_or(nothing);
}

bool is_sure(const Problem& problem, const SearchLimits& limits, const Fit& nothing,
             const Fit& less, const Fit& more) {
  return more.log_evidence - less.evidence_at_best() >=
         std::max(limits.sure_evidence, cost_of_errors(problem, nothing, less));
}

Fit pruned(const Problem& problem, const Fit& whole, const Fit& nothing,
           const SearchLimits& limits) {
  Fit best = whole;
  std::vector<Fit> kept;
  for (std::size_t c = 0; c < best.causes.size();) {
    Fit less = without(problem, best, c, nothing);
    // Stretched tolerances count as misfit. A cause beside others, however small, counts if the data
    // need it or if it is not by chance.
    const double gain = best.log_evidence - less.evidence_at_best();
    const bool material = less.objective - best.objective >=
                          limits.least_share * (nothing.objective - best.objective);
    const double n = problem.observed.number_count();
    const double left = less.excess(n) - excess_of(cost_of_errors(problem, nothing, less), n);
    const bool wanted = left >= limits.least_excess;
    const bool sure = is_sure(problem, limits, nothing, less, best);
    const bool first = best.causes.size() == 1;
    if (gain >= limits.least_evidence && (sure || wanted || (first && material))) {
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

Fit add_simpler(const Problem& problem, Found& found, double equal) {
  Fit best = found.fits.front();
  for (std::size_t c = 0; c < best.causes.size(); ++c) {
    const Fit general = best;  // an earlier cause may have been replaced
    for (auto& simpler : simplified(general.causes[c], problem.structure)) {
      if (!std::isfinite(log_prior(simpler, problem.structure))) continue;
      if (!pushes_alike(problem, general.causes[c], simpler)) continue;
      const double left = may_leave(problem, found, general, c, *simpler.effect);
      Fit start = general;
      start.causes[c] = std::move(simpler);
      FitLimits limits;
      limits.bar = general.objective + kConstants.occam_margin + 2.0 * left;
      auto fit = possible_fit(problem, start, limits);
      if (!fit) continue;
      if (general.log_evidence - fit->log_evidence < std::max(equal, left)) best = *fit;
      keep(found.fits, *std::move(fit), 1);
    }
  }
  return best;
}

void trim(const Problem& problem, Found& found, const SearchLimits& limits, double equal) {
  // Fits with as many or more causes are not worth their evidence, so they are not rivals either.
  const auto put_first = [&](Fit fit) {
    std::erase_if(found.fits,
                  [&](const Fit& other) { return other.causes.size() >= fit.causes.size(); });
    found.fits.insert(found.fits.begin(), std::move(fit));
  };
  const auto count = found.fits.front().causes.size();
  if (count == 0) return;
  Fit lean = pruned(problem, found.fits.front(), found.nothing, limits);
  if (lean.causes.size() < count) {
    put_first(std::move(lean));
  } else {
    found.fits.front() = std::move(lean);  // the same fit, now with its fits without each cause
  }
  const auto left = found.fits.front().causes.size();
  const Fit exchanged = add_simpler(problem, found, equal);
  if (left < 2) return;
  lean = pruned(problem, exchanged, found.nothing, limits);
  if (lean.causes.size() < left) put_first(std::move(lean));
}

}  // namespace chladni::diagnosis
