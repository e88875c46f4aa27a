// How good recorded data are, and in which band: noise, distortion, drift, faults.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "modal/frf_set.h"
#include "recordings/recording_faults.h"
#include "recordings/spectra.h"

namespace chladni::recordings {

/// One part of the band. Responses (i, j) are i + p j.
struct BandQuality {
  double low_hz = 0.0, high_hz = 0.0;
  Eigen::Index lines = 0;
  Eigen::VectorXd deviation;  ///< pq: median over the lines of σ/|G|; infinite: not known
  Eigen::VectorXd
      distortion;  ///< pq: median of the variance over that of the noise; NaN: not known
};

/// Deviations of a band: up to this it is good, up to the next one fair, else noise [1].
inline constexpr double kGoodDeviation = 0.03, kFairDeviation = 0.3;

/// At most six parts of equal width on a logarithmic axis, each of 4 lines or more. None without
/// responses.
[[nodiscard]] std::vector<BandQuality> band_qualities(const modal::FrfSet& set);

/// "good from 5 to 60 Hz (0.4 % at worst); fair from 60 to 100 Hz (y2/u1: 12 %)"
[[nodiscard]] std::string trusted_bands(const modal::FrfSet& set,
                                        const std::vector<BandQuality>& bands);

/// What moves on lines that nothing excites: n lines between excited ones, p outputs.
struct DetectionLevels {
  Eigen::VectorXd hz;     ///< n
  std::vector<char> odd;  ///< n: 1 on odd lines
  Eigen::MatrixXd level;  ///< n×p: amplitude of the mean over periods, rms over the records
  Eigen::MatrixXd noise;  ///< n×p: what noise explains of it
  /// p: power there less that of the noise, over the power on the excited lines [dB]; minus
  /// infinity: not above the noise; NaN: no such line.
  Eigen::VectorXd even_db, odd_db, noise_db;
};

/// None where every line of the band is excited. Even distortion falls on even lines, odd
/// distortion on odd ones, where odd lines are excited (Pintelon and Schoukens 2012, section 4.4).
/// @param drop  periods at the start of each record; two or more must be left
[[nodiscard]] std::optional<DetectionLevels> detection_levels(const SpectraSource& all,
                                                              Eigen::Index drop);

[[nodiscard]] inline std::optional<DetectionLevels> detection_levels(const Spectra& all,
                                                                     Eigen::Index drop) {
  return detection_levels(source_of(all), drop);
}

/// Change of one output from the first to the last period, on the excited lines.
struct PeriodDrift {
  Eigen::Index output = 0;
  double relative = 0.0;  ///< rms of the change over rms of the output
  double excess = 0.0;    ///< deviations above what noise explains
};

/// Outputs that change steadily from period to period by more than noise explains (5 deviations).
/// A transient that was not dropped looks the same. Three periods or more are needed; else empty.
[[nodiscard]] std::vector<PeriodDrift> period_drift(const SpectraSource& excited,
                                                    Eigen::Index drop);
[[nodiscard]] inline std::vector<PeriodDrift> period_drift(const Spectra& excited,
                                                           Eigen::Index drop) {
  return period_drift(source_of(excited), drop);
}

/// All of it, for a person and for files.
struct DataQuality {
  std::vector<std::string> responses, outputs;  ///< names; responses as in BandQuality
  std::string verdict;                          ///< trusted_bands, and the gravest fault
  std::vector<BandQuality> bands;
  std::optional<DetectionLevels> detection;
  std::vector<PeriodDrift> drift;
  RecordingFaults faults;
  std::vector<std::string> done;  ///< what the estimate did: periods, hold, transient, windows
};

}  // namespace chladni::recordings
