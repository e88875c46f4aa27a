#include "diagnosis/readings/readings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "base/interrupt.h"
#include "base/upper_median.h"
#include "diagnosis/constants.h"
#include "diagnosis/readings/bands.h"
#include "diagnosis/readings/channels_read.h"
#include "host/parallel.h"

namespace chladni::diagnosis {
namespace {

using Eigen::ArrayXcd;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr ReadingNumbers kChosen;
constexpr BandNumbers kBands;

// −ln of the density of one response when nothing but the usual error of a model is left.
double least_misfit(Index bands) { return misfit_of(0.0, bands, kBands); }

// The reading of some channels that was found best.
struct Reading {
  std::vector<Supposed> causes;
  double gain = 0.0;  ///< [ln] less the evidence that its parts need
  Eigen::VectorXcd factor;
};

VectorXd delays_of(const Observed& observed) {
  const double period = 2.0 * std::numbers::pi / observed.omega(observed.line_count() - 1);
  const double range = kChosen.longest_delay - kChosen.shortest_delay;
  const auto steps = static_cast<Index>(std::round(range / kChosen.delay_step)) + 1;
  VectorXd delays(2 * steps);
  for (Index n = 0; n < steps; ++n) {
    const double by =
        (kChosen.shortest_delay + static_cast<double>(n) * kChosen.delay_step) * period;
    delays(2 * n) = by;
    delays(2 * n + 1) = -by;
  }
  return delays;
}

// The bands of a response of which at least half was measured.
struct BandsMeasured {
  std::vector<Index> bands;
  VectorXd part;  // of each of them

  [[nodiscard]] Index count() const { return part.size(); }
};

std::vector<BandsMeasured> bands_measured(const Observed& observed, const Bands& bands) {
  const MatrixXd part = bands.average * (observed.weight.array() > 0.0).cast<double>().matrix();
  std::vector<BandsMeasured> each(at(part.cols()));
  for (Index c = 0; c < part.cols(); ++c) {
    auto& own = each[at(c)].bands;
    for (Index b = 0; b < part.rows(); ++b) {
      if (part(b, c) >= 0.5) own.push_back(b);
    }
    each[at(c)].part = part(own, c);
  }
  return each;
}

// Measured responses beside those of a model, whose channels are put right one after the other.
// What was not measured tells nothing of either.
class Read {
 public:
  Read(const Observed& observed, const Bands& bands, MatrixXcd model)
      : observed_(&observed),
        bands_(&bands),
        model_(std::move(model)),
        known_(bands_measured(observed, bands)) {
    measured_ = masked(observed.value);
    model_ = masked(model_);
    distance_ = VectorXd::Zero(model_.cols());
    for (Index c = 0; c < model_.cols(); ++c) {
      if (is_measured(c)) distance_(c) = pair(c, model_.col(c)).distance(1.0);
    }
  }

  /// −ln of the density of all responses.
  [[nodiscard]] double misfit() const {
    double sum = 0.0;
    for (Index c = 0; c < model_.cols(); ++c) {
      if (is_measured(c)) sum += now(c);
    }
    return sum;
  }
  /// The median distance of all responses.
  [[nodiscard]] double distance() const {
    std::vector<double> all;
    for (Index c = 0; c < model_.cols(); ++c) {
      if (is_measured(c)) all.push_back(distance_(c));
    }
    return all.empty() ? 0.0 : upper_median(all);
  }

  /// The best reading of these channels; none if that as it is does.
  [[nodiscard]] std::optional<Reading> best(const ChannelsRead& read) const {
    const auto columns = columns_of(read);
    double possible = -kConstants.least_evidence;
    for (const auto c : columns) possible += now(c) - least_misfit(known_[at(c)].count());
    if (!(possible > 0.0)) return std::nullopt;
    Reading best;
    for (const auto& shape : read.shapes) {
      throw_if_interrupted();
      std::vector<BandPair> pairs;
      for (const auto c : columns) {
        pairs.push_back(pair(c, model_.col(c).cwiseProduct(shape.factor)));
      }
      for (const auto& scale : read.scales) take_better(read, shape, scale, columns, pairs, best);
    }
    if (best.causes.empty()) return std::nullopt;
    return best;
  }

  void take(const ChannelsRead& read, const Reading& reading) {
    for (const auto c : columns_of(read)) {
      model_.col(c) = model_.col(c).cwiseProduct(reading.factor).eval();
      distance_(c) = pair(c, model_.col(c)).distance(1.0);
    }
  }

 private:
  [[nodiscard]] MatrixXcd masked(const MatrixXcd& value) const {
    return (observed_->weight.array() > 0.0)
        .select(value, MatrixXcd::Zero(value.rows(), value.cols()));
  }
  [[nodiscard]] bool is_measured(Index c) const { return known_[at(c)].count() > 0; }
  [[nodiscard]] double misfit_at(Index c, double distance) const {
    return misfit_of(distance, known_[at(c)].count(), kBands);
  }
  [[nodiscard]] double now(Index c) const { return misfit_at(c, distance_(c)); }
  [[nodiscard]] BandPair pair(Index c, const Eigen::VectorXcd& model) const {
    const auto& known = known_[at(c)];
    const auto averaged = [&](const Eigen::VectorXcd& value) -> Eigen::VectorXcd {
      const Eigen::VectorXcd all = bands_->average * value;
      return all(known.bands).array() / known.part.array();
    };
    return {averaged(measured_.col(c)), averaged(model)};
  }
  // Responses of a channel that were measured.
  [[nodiscard]] std::vector<Index> columns_of(const ChannelsRead& read, Index channel) const {
    std::vector<Index> columns;
    const Index others = read.sensors ? observed_->inputs : observed_->outputs;
    for (Index o = 0; o < others; ++o) {
      const Index c =
          read.sensors ? channel + observed_->outputs * o : o + observed_->outputs * channel;
      if (is_measured(c)) columns.push_back(c);
    }
    return columns;
  }
  // Those of all its channels, channel by channel.
  [[nodiscard]] std::vector<Index> columns_of(const ChannelsRead& read) const {
    std::vector<Index> columns;
    for (const auto channel : read.channels) {
      const auto own = columns_of(read, channel);
      columns.insert(columns.end(), own.begin(), own.end());
    }
    return columns;
  }
  // What each channel that was measured gains; the sum over its columns of `gains`.
  [[nodiscard]] std::vector<double> of_channels(const ChannelsRead& read,
                                                const std::vector<double>& gains) const {
    std::vector<double> sums;
    auto gain = gains.begin();
    for (const auto channel : read.channels) {
      const auto count = std::ssize(columns_of(read, channel));
      if (count > 0) sums.push_back(std::accumulate(gain, gain + count, 0.0));
      gain += count;
    }
    return sums;
  }
  // Each of the channels must gain by itself, and the model must then explain the averages. A delay
  // alone is no reading: what hangs on the body, or a low-pass, looks alike in wide averages.
  void take_better(const ChannelsRead& read, const ReadingPart& shape, const ReadingPart& scale,
                   const std::vector<Index>& columns, const std::vector<BandPair>& pairs,
                   Reading& best) const {
    const auto is_choice = [](const Supposed& cause) { return cause.x.size() == 0; };
    if (scale.causes.empty() && std::ranges::none_of(shape.causes, is_choice)) return;
    const double factor = scale.factor(0).real();
    std::vector<double> distances;
    std::vector<double> gains;
    for (std::size_t n = 0; n < columns.size(); ++n) {
      distances.push_back(pairs[n].distance(factor));
      gains.push_back(now(columns[n]) - misfit_at(columns[n], distances.back()));
    }
    const auto parts = static_cast<double>(shape.causes.size() + scale.causes.size());
    const double gain =
        std::accumulate(gains.begin(), gains.end(), -kConstants.least_evidence * parts);
    if (gain <= best.gain || std::ranges::min(of_channels(read, gains)) <= 0.0) return;
    if (upper_median(distances) > kChosen.most_distance) return;
    best.causes = scale.causes;
    best.causes.insert(best.causes.end(), shape.causes.begin(), shape.causes.end());
    best.gain = gain;
    best.factor = factor * shape.factor;
  }

  const Observed* observed_;
  const Bands* bands_;
  MatrixXcd measured_, model_;        // K×pq
  std::vector<BandsMeasured> known_;  // pq
  VectorXd distance_;                 // pq; 0 where not measured
};

// Readings beside one shift of the model's frequencies.
struct Shifted {
  std::vector<Supposed> causes;
  double misfit = 0.0;  ///< with the evidence that the causes need
  double distance = 0.0;
};

Shifted found_at(double shift, const Problem& problem, const Bands& bands,
                 const std::vector<ChannelsRead>& sets) {
  const State state = state_of(problem.structure);
  // All frequencies times e^shift: at ω as the model is at ω e^-shift, its level times e^(-2
  // shift).
  const VectorXd omega = std::exp(-shift) * problem.observed.omega;
  Read read(problem.observed, bands, std::exp(-2.0 * shift) * responses(state, omega, false));
  Shifted found;
  std::vector<bool> done(sets.size(), false);
  for (;;) {
    std::vector<std::optional<Reading>> each(sets.size());
    parallel_tasks(sets.size(), [&](std::size_t n) {
      if (!done[n]) each[n] = read.best(sets[n]);
    });
    const auto gain = [](const auto& reading) { return reading ? reading->gain : 0.0; };
    const auto best = std::ranges::max_element(each, {}, gain);
    if (best == each.end() || !*best) break;
    const auto n = static_cast<std::size_t>(best - each.begin());
    read.take(sets[n], **best);
    done[n] = true;
    found.causes.insert(found.causes.end(), (*best)->causes.begin(), (*best)->causes.end());
  }
  const auto count = static_cast<double>(found.causes.size());
  found.misfit = read.misfit() + kConstants.least_evidence * count;
  found.distance = read.distance();
  return found;
}

std::optional<Fit> fitted_if_possible(const Problem& problem, const Fit& start) {
  try {
    return fitted(problem, start);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<Supposed> readings(const Problem& problem,
                               const std::vector<const Effect*>& catalogue) {
  const auto& observed = problem.observed;
  const auto sets =
      channels_read(problem.structure, catalogue, observed.omega, delays_of(observed));
  if (sets.empty()) return {};
  const Bands bands = bands_of(observed.omega, kBands);
  Shifted best = found_at(0.0, problem, bands, sets);
  const double right = kBands.least_error;  // mean square: four times as far as the usual error
  for (double shift = kChosen.shift_step; shift < kChosen.most_shift + 1e-9;
       shift += kChosen.shift_step) {
    for (const double sign : {1.0, -1.0}) {
      if (best.distance < right) break;
      Shifted other = found_at(sign * shift, problem, bands, sets);
      // A shift is a cause too.
      if (other.misfit + kConstants.least_evidence < best.misfit) best = std::move(other);
    }
  }
  return best.causes;
}

std::optional<Fit> fitted_with_readings(const Problem& problem,
                                        const std::vector<const Effect*>& catalogue,
                                        const Fit& nothing, double least_evidence) {
  Fit start;
  start.causes = readings(problem, catalogue);
  if (start.causes.empty()) return std::nullopt;
  start.eta = VectorXd::Zero(nothing.eta.size());
  auto fit = fitted_if_possible(problem, start);
  if (fit && fit->log_evidence < nothing.log_evidence + least_evidence) return std::nullopt;
  return fit;
}

std::optional<Fit> fitted_with_lost(const Problem& problem, const std::vector<Supposed>& read,
                                    const Fit& best, double least_evidence) {
  Fit start = best;
  start.less.clear();
  for (const auto& cause : read) {
    const bool there = std::ranges::any_of(best.causes, [&](const Supposed& other) {
      return other.effect == cause.effect && other.option == cause.option;
    });
    if (!there) start.causes.push_back(cause);
  }
  if (start.causes.size() == best.causes.size()) return std::nullopt;
  const double enough = best.evidence_at_best() + least_evidence;
  std::optional<Fit> found;
  for (const double part : {1.0, 0.0}) {  // tolerances of `best`, or at rest
    start.eta = part * best.eta;
    auto fit = fitted_if_possible(problem, start);
    const bool better = fit && fit->log_evidence >= (found ? found->log_evidence : enough);
    if (better) found = std::move(fit);
  }
  return found;
}

}  // namespace chladni::diagnosis
