#include "diagnosis/modes/specimens/hypotheses.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/specimens/specimen_constants.h"
#include "diagnosis/modes/weighed.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

double ln_prior(const Supposition& supposed, double entries, double bodies) {
  if (supposed.unlike >= 0) return std::log(0.5 * kSpecimens.unlike_prior / bodies);
  return log_of_number(supposed.entries.size(), entries);
}

std::vector<Index> entries_that_may_be_wrong(const Series& series) {
  std::vector<Index> all;
  for (std::size_t e = 0; e < series.entries.size(); ++e) {
    if (series.entries[e].may_be_wrong) all.push_back(static_cast<Index>(e));
  }
  return all;
}

// The most promising of some hypotheses are fitted in full from the levels of `base`.
class Candidates {
 public:
  Candidates(const JointModel& model, const JointFit& base) : model_(model), base_(base) {}

  // @param more  what `supposed` has beyond the hypothesis of `base`
  void add(Supposition supposed, const Supposition& more) {
    JointFit fit;
    fit.log_evidence = base_.log_evidence + model_.promise(base_, more);
    fit.supposed = std::move(supposed);
    all_.push_back(std::move(fit));
  }
  [[nodiscard]] std::vector<JointFit> fitted(int in_full) && {
    std::ranges::stable_sort(all_, std::ranges::greater{}, &JointFit::log_evidence);
    parallel_tasks(std::min(all_.size(), static_cast<std::size_t>(in_full)), [&](std::size_t i) {
      all_[i] = model_.fitted(all_[i].supposed, base_.ln_levels);
    });
    return std::move(all_);
  }

 private:
  const JointModel& model_;
  const JointFit& base_;
  std::vector<JointFit> all_;
};

std::vector<JointFit> with_one_entry_more(const JointModel& model, const JointFit& base,
                                          const std::vector<Index>& entries, int in_full) {
  Candidates candidates(model, base);
  for (const Index e : entries) {
    auto more = base.supposed.entries;
    if (std::ranges::find(more, e) != more.end()) continue;
    more.push_back(e);
    std::ranges::sort(more);
    candidates.add({more}, {{e}});
  }
  return std::move(candidates).fitted(in_full);
}

std::vector<JointFit> unlike_bodies(const JointModel& model, const JointFit& none, Index bodies) {
  std::vector<JointFit> all;
  for (const bool by_modes : {false, true}) {
    Candidates candidates(model, none);
    for (Index b = 0; b < bodies; ++b) candidates.add({{}, b, by_modes}, {{}, b, by_modes});
    auto fits = std::move(candidates).fitted(kSpecimens.carried);
    std::ranges::move(fits, std::back_inserter(all));
  }
  return all;
}

bool is_in(const std::vector<JointFit>& fits, const Supposition& supposed) {
  return std::ranges::any_of(fits, [&](const JointFit& fit) { return fit.supposed == supposed; });
}

// The fits with one entry more than the best ones of `fits` that were fitted in full.
std::vector<JointFit> next_level(const JointModel& model, const std::vector<JointFit>& fits,
                                 const std::vector<Index>& entries) {
  std::vector<const JointFit*> best;
  for (const auto& fit : fits) {
    if (fit.inverse.size() > 0) best.push_back(&fit);
  }
  std::ranges::stable_sort(best, std::ranges::greater{},
                           [](const JointFit* fit) { return fit->log_evidence; });
  if (best.size() > at(kSpecimens.carried)) best.resize(at(kSpecimens.carried));
  std::vector<JointFit> all;
  for (const auto* base : best) {
    for (auto& fit : with_one_entry_more(model, *base, entries, kSpecimens.carried)) {
      if (!is_in(all, fit.supposed)) all.push_back(std::move(fit));
    }
  }
  return all;
}

WeighedFits weighed(std::vector<JointFit> fits, double entries, double bodies) {
  std::vector<double> weight;
  for (const auto& fit : fits) {
    weight.push_back(fit.log_evidence + ln_prior(fit.supposed, entries, bodies));
  }
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return weight[i]; });
  WeighedFits all;
  double sum = 0.0;
  for (const auto i : order) {
    all.fits.push_back(std::move(fits[i]));
    all.probability.push_back(std::exp(weight[i] - weight[order.front()]));
    sum += all.probability.back();
  }
  for (auto& one : all.probability) one /= sum;
  return all;
}

}  // namespace

const JointFit& WeighedFits::none() const {
  return *std::ranges::find_if(fits, [](const JointFit& fit) { return fit.supposed.is_none(); });
}

double WeighedFits::probability_of(Index entry) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const auto& own = fits[i].supposed.entries;
    if (std::ranges::find(own, entry) != own.end()) sum += probability[i];
  }
  return std::min(sum, 1.0);
}

WeighedFits weighed_hypotheses(const JointModel& model, const Series& series, int most_entries) {
  const auto entries = entries_that_may_be_wrong(series);
  const auto n = static_cast<double>(std::max<std::size_t>(entries.size(), 1));
  const JointFit none = model.fitted({}, {});
  auto all = unlike_bodies(model, none, series.body_count());
  std::vector<JointFit> level{none};
  for (int count = 1; count <= std::min(most_entries, 3); ++count) {
    auto next = count == 1 ? with_one_entry_more(model, none, entries, kSpecimens.in_full)
                           : next_level(model, level, entries);
    std::ranges::move(level, std::back_inserter(all));
    level = std::move(next);
  }
  std::ranges::move(level, std::back_inserter(all));
  auto result = weighed(std::move(all), n, static_cast<double>(series.body_count()));
  // The most probable one is what is told: it is fitted in full.
  auto& best = result.fits.front();
  if (best.inverse.size() == 0) best = model.fitted(best.supposed, none.ln_levels);
  return result;
}

std::vector<Index> set_strays_aside(Series& series, bool learned) {
  std::vector<Index> strays;
  const double variance = kSpecimens.stray * kSpecimens.stray;
  const auto most =
      static_cast<std::size_t>(kSpecimens.strays_at_most * static_cast<double>(series.count()));
  while (strays.size() < most) {
    const JointFit none = JointModel(series, learned).fitted({}, {});
    Index worst = -1;
    double most_gain = -std::log(kSpecimens.stray_prior);
    for (Index i = 0; i < series.count(); ++i) {
      if (series.rows[at(i)].mode < 0) continue;
      const double room = 1.0 + variance * none.inverse(i, i);
      const double gain =
          0.5 * variance * std::pow(none.weighted(i), 2) / room - 0.5 * std::log(room);
      if (gain > most_gain) {
        most_gain = gain;
        worst = i;
      }
    }
    if (worst < 0) break;
    series.noise(worst) = std::hypot(series.noise(worst), kSpecimens.stray);
    strays.push_back(worst);
  }
  return strays;
}

}  // namespace chladni::diagnosis
