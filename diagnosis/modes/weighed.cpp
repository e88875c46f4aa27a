#include "diagnosis/modes/weighed.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnosis/constants.h"
#include "diagnosis/verdict/counterparts.h"

namespace chladni::diagnosis {

bool contains(const Structure& structure, const ModesFit& fit, const Supposed& cause) {
  return std::ranges::any_of(fit.causes,
                             [&](const Supposed& other) { return alike(structure, cause, other); });
}

double log_of_number(std::size_t causes, double effects) {
  const double n = std::max(effects, 1.0);
  switch (causes) {
    case 0:
      return std::log(kConstants.nothing_prior);
    case 1:
      return std::log(kConstants.one_prior / n);
    case 2:
      return std::log(kConstants.two_prior * 2.0 / (n * n));
    default:
      return std::log(kConstants.three_prior * 6.0 / (n * n * n));
  }
}

bool are_alike(const Structure& structure, const ModesFit& a, const ModesFit& b) {
  if (a.causes.size() != b.causes.size() || a.disturbed.what != b.disturbed.what ||
      a.disturbed.index != b.disturbed.index) {
    return false;
  }
  return std::ranges::all_of(a.causes,
                             [&](const Supposed& cause) { return contains(structure, b, cause); });
}

namespace {

// True if `a` is a special case of `b`, of the same choice and at the same place.
bool is_case_of(const Structure& structure, const Supposed& a, const Supposed& b) {
  return a.option == b.option && near(structure, a, b, 2.0 * kConstants.same_place) &&
         std::ranges::any_of(b.effect->simpler,
                             [&](const Simpler& one) { return one.effect == a.effect; });
}

// True if each cause of `general` has one of its own in `fit`, itself or its simpler case, and one
// is simpler. No fit is simpler than itself.
bool is_simpler(const Structure& structure, const ModesFit& fit, const ModesFit& general) {
  if (fit.causes.size() != general.causes.size()) return false;
  const auto is_same = [&](const Supposed& cause, const Supposed& one) {
    return alike(structure, one, cause);
  };
  const auto found = counterparts(general.causes, fit.causes, is_same,
                                  [&](const Supposed& cause, const Supposed& one) {
                                    return is_case_of(structure, one, cause);
                                  });
  return found && !std::ranges::equal(general.causes, *found,
                                      [&](const Supposed& cause, const Supposed* one) {
                                        return is_same(cause, *one);
                                      });
}

// The likeliest fit that is a simpler case of `general` and has nearly its evidence; null if there
// is none.
const ModesFit* simpler_of(const Structure& structure, const ModesFound& found,
                           const ModesFit& general, double equal) {
  const ModesFit* best = nullptr;
  for (const auto& other : found.fits) {
    if (!(other.log_evidence > general.log_evidence - equal)) continue;
    if (!is_simpler(structure, other, general)) continue;
    if (best == nullptr || other.log_evidence > best->log_evidence) best = &other;
  }
  return best;
}

// A hypothesis and ln of its weight.
struct Weight {
  const ModesFit* fit = nullptr;
  double log = 0.0;
};

// General causes whose simpler case has nearly their evidence: each with the simplest one. Other
// fits of one explanation are the same maximum, reached from other starts.
struct Heir {
  const ModesFit *fit, *general;
};
std::vector<Heir> heirs_of(const Structure& structure, const ModesFound& found, double equal) {
  std::vector<Heir> heirs;
  for (const auto& fit : found.fits) {
    const auto* simpler = simpler_of(structure, found, fit, equal);
    const bool is_known = std::ranges::any_of(
        heirs, [&](const Heir& heir) { return are_alike(structure, *heir.general, fit); });
    if (simpler == nullptr || is_known) continue;
    while (const auto* next = simpler_of(structure, found, *simpler, equal)) simpler = next;
    heirs.push_back({simpler, &fit});
  }
  return heirs;
}

double log_weight(const ModesFound& found, const ModesFit& fit) {
  return found.evidence_power * fit.log_evidence + log_of_number(fit.causes.size(), found.effects);
}

// The hypotheses that stand by themselves.
std::vector<Weight> weights_of(const Structure& structure, const ModesFound& found, double equal) {
  std::vector<Weight> all{{&found.nothing, log_weight(found, found.nothing)}};
  for (const auto& fit : found.fits) {
    if (simpler_of(structure, found, fit, equal) == nullptr) {
      all.push_back({&fit, log_weight(found, fit)});
    }
  }
  const auto disturbed = static_cast<double>(std::max<std::size_t>(found.disturbed.size(), 1));
  const double prior = std::log(kConstants.disturbed_prior / disturbed);
  for (const auto& fit : found.disturbed) {
    all.push_back({&fit, found.evidence_power * fit.log_evidence + prior});
  }
  return all;
}

Weighed weighed_by_themselves(const Structure& structure, const ModesFound& found, double equal) {
  const auto weights = weights_of(structure, found, equal);
  const double most = std::ranges::max_element(weights, {}, &Weight::log)->log;
  Weighed all;
  for (const auto& one : weights) {
    all.fits.push_back(one.fit);
    all.probability.push_back(std::exp(one.log - most));
  }
  for (const auto& heir : heirs_of(structure, found, equal)) {
    const auto first = std::ranges::find(all.fits, heir.fit) - all.fits.begin();
    all.probability[static_cast<std::size_t>(first)] +=
        std::exp(log_weight(found, *heir.general) - most);
  }
  return all;
}

// Each explanation once, at its best fit, descending. Other fits of it are the same maximum,
// reached from other starts: their probabilities do not count.
Weighed merged(const Structure& structure, const Weighed& all) {
  Weighed result;
  std::vector<std::size_t> order(all.fits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t i) { return all.probability[i]; });
  for (const auto i : order) {
    const auto known = std::ranges::find_if(
        result.fits, [&](const ModesFit* fit) { return are_alike(structure, *fit, *all.fits[i]); });
    if (known == result.fits.end()) {
      result.fits.push_back(all.fits[i]);
      result.probability.push_back(all.probability[i]);
    }
  }
  const double sum = std::accumulate(result.probability.begin(), result.probability.end(), 0.0);
  for (auto& one : result.probability) one /= sum;
  return result;
}

}  // namespace

Weighed weighed(const Structure& structure, const ModesFound& found, double equal) {
  return merged(structure, weighed_by_themselves(structure, found, equal));
}

double probability_of(const Structure& structure, const Weighed& all, const Supposed& cause) {
  double sum = 0.0;
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (contains(structure, *all.fits[i], cause)) sum += all.probability[i];
  }
  return std::min(sum, 1.0);
}

bool is_supported(const ModesFound& found, const ModesFit& fit, double least_evidence) {
  if (!fit.has_clear_sizes) return false;
  if (fit.causes.size() < 2) return true;
  double fewer = found.nothing.log_evidence;
  for (const auto& other : found.fits) {
    if (other.causes.size() < fit.causes.size()) fewer = std::max(fewer, other.log_evidence);
  }
  return fit.log_evidence >= fewer + least_evidence;
}

bool is_part_of_more(const Structure& structure, const ModesFound& found, const ModesFit& fit,
                     double least_evidence) {
  return std::ranges::any_of(found.fits, [&](const ModesFit& other) {
    return other.causes.size() > fit.causes.size() &&
           other.log_evidence >= fit.log_evidence + least_evidence &&
           std::ranges::all_of(fit.causes, [&](const Supposed& cause) {
             return contains(structure, other, cause);
           });
  });
}

void put_supported_first(const Structure& structure, const ModesFound& found, double least_evidence,
                         Weighed& all) {
  const auto first = std::ranges::find_if(all.fits, [&](const ModesFit* fit) {
    return !fit->causes.empty() && is_supported(found, *fit, least_evidence);
  });
  if (first == all.fits.end()) return;
  const auto is_of_best = [&](const Supposed& cause) {
    return contains(structure, *all.fits.front(), cause);
  };
  if (!std::ranges::all_of((*first)->causes, is_of_best)) return;
  const auto at = first - all.fits.begin();
  std::rotate(all.fits.begin(), first, first + 1);
  std::rotate(all.probability.begin(), all.probability.begin() + at,
              all.probability.begin() + at + 1);
}

}  // namespace chladni::diagnosis
