#include "recordings/frf_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "recordings/constants.h"
#include "recordings/estimate/line_variance.h"
#include "recordings/estimate/local_transient.h"
#include "recordings/recordings.h"

namespace chladni::recordings {
namespace {

std::vector<ChannelChoice> all_of(Side side, std::size_t count) {
  std::vector<ChannelChoice> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back({side, static_cast<Eigen::Index>(i)});
  return result;
}

Eigen::Index smoothing(const FrfEstimateOptions& options, Eigen::Index freedom) {
  return options.smooth_lines ? *options.smooth_lines : lines_for_freedom(freedom);
}

// Lines with noise of their own over which a variance is averaged: those in the middle of the band
// stand for all. What differs between realisations differs on each line by itself.
double lines_of_variance(const Spectra& spectra, Eigen::Index half, Eigen::Index realisations) {
  if (spectra.cleaned_periods == 0 || realisations > 1) return static_cast<double>(2 * half + 1);
  const auto middle = spectra.line_count() / 2;
  const auto first = std::max<Eigen::Index>(0, middle - half);
  const auto last = std::min(spectra.line_count() - 1, middle + half);
  const auto& line = spectra.line;
  return lines_apart({line.begin() + first, line.begin() + last + 1}, spectra.cleaned_periods,
                     spectra.period);
}

}  // namespace

Eigen::Index lines_for_freedom(Eigen::Index freedom) {
  if (freedom < 1) return 0;
  const double lines = std::ceil(Constants::enough_freedom / static_cast<double>(freedom));
  return std::min(Constants::most_smoothing,
                  static_cast<Eigen::Index>(std::ceil(0.5 * (lines - 1.0))));
}

Spectra excited_part(const Spectra& all, const FrfEstimateOptions& options) {
  return part(all, excited_places(source_of(all), options));
}

std::vector<Eigen::Index> excited_places(const SpectraSource& all,
                                         const FrfEstimateOptions& options) {
  auto places = excited_lines(all);
  std::erase_if(places, [&](Eigen::Index k) {
    const double hz = all.head.hz(static_cast<std::size_t>(k));
    return hz < options.low_hz || (options.high_hz > 0.0 && hz > options.high_hz);
  });
  require(!places.empty(), "FRF estimate: no line in the band is excited");
  return places;
}

void fill(const Spectra& spectra, const TransferVariances& found, const FrfEstimateOptions& options,
          FrfEstimate& estimate) {
  auto& set = estimate.set;
  set.frequency_hz.resize(spectra.line_count());
  for (Eigen::Index k = 0; k < spectra.line_count(); ++k) {
    set.frequency_hz(k) = spectra.hz(static_cast<std::size_t>(k));
  }
  const auto half = smoothing(options, found.total_freedom);
  set.variance =
      averaged_variances(found.total, set.value, half, static_cast<double>(found.total_freedom));
  set.noise_variance =
      averaged_variances(found.noise, set.value, smoothing(options, found.noise_freedom),
                         static_cast<double>(found.noise_freedom));
  set.averages = found.total.empty() ? 0.0
                                     : static_cast<double>(found.total_freedom) *
                                           lines_of_variance(spectra, half, estimate.realisations);
  if (half > 0) {
    estimate.notes.push_back("variances are averaged over " + fmt::to_string(2 * half + 1) +
                             " lines");
  }
  if (estimate.periods < 2) {
    estimate.notes.emplace_back(
        "one period is left: noise cannot be told from nonlinearity; measure more periods");
  }
  if (estimate.realisations < 2) {
    estimate.notes.emplace_back(set.variance.empty()
                                    ? "one period of one realisation: nothing tells the variance"
                                    : "one realisation: the variance is that of the noise alone");
  }
  const double sampling = 1.0 / spectra.sample_time_s;
  if (set.frequency_hz.size() > 0 &&
      set.frequency_hz.tail(1)(0) > Constants::folds_from * sampling) {
    estimate.notes.push_back("lines above " +
                             fmt::format("{:.6g}", Constants::folds_from * sampling) +
                             " Hz lie near half the sampling frequency: what moves above it folds "
                             "onto them");
  }
  if (estimate.transient.seen || estimate.transient.drop == 0) {
    estimate.notes.push_back(estimate.transient.text);
  }
}

FrfEstimate frf_estimate(const Spectra& all, const FrfEstimateOptions& options) {
  require(!all.records.empty(), "FRF estimate: no record");
  const auto spectra = excited_part(all, options);
  return frf_estimate_of_excited(source_of(spectra), options);
}

FrfEstimate frf_estimate_of_excited(const SpectraSource& spectra,
                                    const FrfEstimateOptions& options) {
  FrfEstimate result;
  result.transient = transient(spectra);
  result.dropped = options.drop.value_or(result.transient.drop);
  const TransferPlan plan{.to = all_of(Side::outputs, spectra.head.outputs.size()),
                          .from = all_of(Side::inputs, spectra.head.inputs.size()),
                          .drop = result.dropped};
  auto mean = transfer(spectra, plan);
  result.periods = mean.periods;
  result.realisations = mean.realisations;
  const auto found =
      variances(spectra, plan, mean,
                [](std::size_t, const Eigen::MatrixXcd& deviation) { return deviation; });
  result.set.outputs = spectra.head.outputs;
  result.set.inputs = spectra.head.inputs;
  result.set.value = std::move(mean.value);
  fill(spectra.head, found, options, result);
  return result;
}

std::pair<Spectra, FrfEstimateOptions> prepared(const TimeData& data,
                                                const FrfEstimateOptions& options,
                                                TransientReport& about) {
  const auto missing = missing_side(data);
  require(missing.empty(), "FRF estimate: " + missing);
  auto all = spectra(data, options.low_hz, options.high_hz);
  if (!options.remove_transient) return {std::move(all), options};
  about = transient(excited_part(all, options));
  auto own = options;
  own.drop = 0;
  return {without_start(data, options.low_hz, options.high_hz), own};
}

void tell_removed(const TimeData& data, const TransientReport& about, FrfEstimate& estimate) {
  tell_removed(fewest_periods(recordings_of(data)), about, estimate);
}

Eigen::Index first_steady_period(const FrfEstimate& estimate) {
  return std::max<Eigen::Index>(estimate.dropped, estimate.transient.seen ? 2 : 1);
}

void tell_removed(Eigen::Index periods, const TransientReport& about, FrfEstimate& estimate) {
  estimate.periods = periods;
  std::erase(estimate.notes, estimate.transient.text);
  estimate.transient = about;
  estimate.transient.drop = 0;
  estimate.transient.remaining = 0.0;
  if (!about.seen) return;
  estimate.transient.text = fmt::format(
      "a transient of which each period leaves {:.3g} was taken off all {} periods by what lies "
      "between the lines; none was dropped",
      about.decay, periods);
  estimate.notes.push_back(estimate.transient.text);
}

FrfEstimate frf_estimate(const TimeData& data, const FrfEstimateOptions& options) {
  TransientReport about;
  const auto [all, own] = prepared(data, options, about);
  auto result = frf_estimate(all, own);
  if (options.remove_transient) tell_removed(data, about, result);
  return result;
}

}  // namespace chladni::recordings
