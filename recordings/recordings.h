// Recordings of which a few periods at a time are in memory.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "recordings/data_quality.h"
#include "recordings/frf_estimate.h"
#include "recordings/recording_faults.h"
#include "recordings/time_data.h"

namespace chladni::recordings {

/// Recordings that may be larger than the memory: samples are read when they are asked for, several
/// times. They are sound as check(TimeData) asks.
struct Recordings {
  struct Place {
    Eigen::Index samples = 0;
    int experiment = 0, realisation = 0;
  };
  TimeData head;  ///< channels and sampling, without records
  std::vector<Place> records;
  /// `count` samples from `first` on of one channel of one record.
  std::function<Eigen::VectorXd(std::size_t record, Side side, Eigen::Index channel,
                                Eigen::Index first, Eigen::Index count)>
      samples;
};

/// Those that are in memory. @param data  outlives them
[[nodiscard]] Recordings recordings_of(const TimeData& data);

/// Periods of the shortest record. @pre a record, a period
[[nodiscard]] Eigen::Index fewest_periods(const Recordings& recordings);

/// As recording_faults(TimeData). Memory: one channel of some periods.
[[nodiscard]] RecordingFaults recording_faults(const Recordings& recordings);

/// What a periodic experiment gives that is read period by period.
struct PeriodicEstimate {
  FrfEstimate estimate;
  std::optional<DetectionLevels> detection;
  std::vector<PeriodDrift> drift;
};

/// The estimate of frf_estimate(), with references that of closed_loop_estimate(), and what
/// detection_levels() and period_drift() say of the recordings: the same bits, since every sum
/// is made in the same order.
/// Memory: the spectra of one period, on all lines; where the transient is removed those of one
/// realisation on the excited lines, 14 "periods" each, and some 40 periods of one channel. It does
/// not grow with the number of periods or realisations.
/// Cost: about fifteen passes over the samples, each with transforms.
/// @throws InvalidInput  as these
[[nodiscard]] PeriodicEstimate periodic_estimate(const Recordings& recordings,
                                                 const FrfEstimateOptions& options);

}  // namespace chladni::recordings
