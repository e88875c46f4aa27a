// The trial of an observer: it runs over recordings, and held-out sensors judge its estimates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "steps/observer.h"

namespace chladni::steps {

/// Root mean square of what is wrong, over that of the judge's motion, over all settled samples.
/// NaN: the method cannot be used here.
struct JudgedErrors {
  std::string judge;
  double rms = 0.0;    ///< of the judge's motion [m]
  double noise = 0.0;  ///< of the judge itself, relative: what a perfect estimate would leave; NaN:
                       ///< not known
  double observer = 0.0;
  double prediction = 0.0;  ///< of the observer without this sample's sensors
  /// The sensors' values through the shapes of the lowest k modes, k with the least error: static
  /// interpolation.
  double interpolation = 0.0;
  Eigen::Index interpolation_modes = 0;  ///< k
  double rigid = 0.0;                    ///< rigid-body motion of the sensors, extrapolated
  double model = 0.0;                    ///< the model without any sensor, from the known forces
  double truth = 0.0;                    ///< the filter that knows the true structure
  double covered = 0.0;  ///< part of the samples within the stated 95 % band and the judge's own
                         ///< noise; NaN: that noise is not known
  double covered_widened = 0.0;  ///< within the band times `Replay::surprise`
};

/// Part of a record for a picture.
struct ReplayCourse {
  Eigen::VectorXd time_s;
  Eigen::MatrixXd measured, estimate, deviation;  ///< N×j, of the judges
};

struct Replay {
  double seconds = 0.0;   ///< of all records, without what is left out while settling
  double settle_s = 0.0;  ///< left out of each record
  std::vector<JudgedErrors> judges;
  /// Root mean square of the innovations over their stated deviations: 1 for a perfect model. Above
  /// 1 the model errs by more than noise and disturbances explain, and so does the band.
  double surprise = 0.0;
  Eigen::VectorXd surprise_of;  ///< of each sensor alone
  ReplayCourse course;          ///< of the first record
  std::vector<std::string> notes;
};

/// @param truth  the filter of the true structure, whose points are the judges; or none
/// @throws InvalidInput  there is no judge; records shorter than the filter settles
[[nodiscard]] Replay replay(const study::Study& study, const Observer& observer,
                            const Recordings& recordings,
                            const std::optional<modal::KalmanFilter>& truth);

/// The filter of the study in observer.truth, on its own modes, with the delay of its experiment
/// and the disturbances and noise of the observer. None, and a note, where it cannot be made.
[[nodiscard]] std::optional<modal::KalmanFilter> true_filter(const study::Study& study,
                                                             const Observer& observer,
                                                             stage::Work& work);

}  // namespace chladni::steps
