// Spectra of a periodic experiment, for each period, on the lines of interest.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "recordings/time_data.h"

namespace chladni::recordings {

/// K lines. They need far less memory than the samples if the band is narrow, so the realisations
/// of a long experiment can be transformed one after the other.
struct Spectra {
  std::vector<modal::MeasuredChannel> outputs, inputs, references;
  double sample_time_s = 0.0;
  Eigen::Index period = 0;         ///< samples
  std::vector<Eigen::Index> line;  ///< K, indices in the transform of one period, ascending

  struct Record {
    int experiment = 0, realisation = 0;
    std::vector<Eigen::MatrixXcd> outputs, inputs, references;  ///< [period], K×channels
  };
  std::vector<Record> records;
  /// Periods of the recordings, the fewest, whose start was taken off by what lies between the
  /// lines (estimate/local_transient.h), so that the noise of neighbouring lines is partly one; 0:
  /// it was not.
  Eigen::Index cleaned_periods = 0;

  [[nodiscard]] double hz(std::size_t k) const {
    return static_cast<double>(line[k]) / (static_cast<double>(period) * sample_time_s);
  }
  [[nodiscard]] Eigen::Index line_count() const { return static_cast<Eigen::Index>(line.size()); }
};

/// One period of a record, K×channels on each side.
struct PeriodSpectra {
  const Eigen::MatrixXcd *outputs = nullptr, *inputs = nullptr, *references = nullptr;
  std::shared_ptr<const void> owner;  ///< of the matrices; null: they outlive the source
};

/// Spectra of which a period is made when it is asked for. Estimates go from period to period and
/// keep sums, so that their memory does not grow with the number of periods or records, and sum in
/// the same order wherever the periods are.
struct SpectraSource {
  struct Place {
    int experiment = 0, realisation = 0;
    std::size_t periods = 0;
  };
  Spectra head;  ///< without records
  std::vector<Place> records;
  std::function<PeriodSpectra(std::size_t record, std::size_t period)> period;
};

/// Those that are there already. @param spectra  outlives the source
[[nodiscard]] SpectraSource source_of(const Spectra& spectra);

/// The lines between two frequencies (high 0: all), without 0 Hz and half the sampling frequency.
/// @throws InvalidInput  no period stated, a record without a whole number of periods, no line
[[nodiscard]] Spectra spectra(const TimeData& data, double low_hz = 0.0, double high_hz = 0.0);

/// Channels, sampling and the lines between two frequencies, without records.
/// @throws InvalidInput  no line
[[nodiscard]] Spectra lines_between(const TimeData& data, double low_hz, double high_hz);

/// @param samples  of each record
/// @throws InvalidInput  no period stated, a record without a whole number of periods
void check_periods(const TimeData& head, const std::vector<Eigen::Index>& samples);
void check_periods(const TimeData& data);

/// Adds the records of `more`. @throws InvalidInput  other channels, lines or sampling
void append(Spectra& all, Spectra more);

/// The lines on which every input (in a loop every reference) was excited: by more than 1e-6 of the
/// power of its strongest line, in one experiment or more.
[[nodiscard]] std::vector<Eigen::Index> excited_lines(const SpectraSource& spectra);
[[nodiscard]] std::vector<Eigen::Index> excited_lines(const Spectra& spectra);

/// Only these lines, given by their indices in `line`.
[[nodiscard]] Spectra part(const Spectra& spectra, const std::vector<Eigen::Index>& places);

}  // namespace chladni::recordings
