// The loop of an observer in simulation: feedback on its estimate against feedback on the sensors.
#pragma once

#include <string>
#include <vector>

#include "steps/observer.h"

namespace chladni::steps {

/// One of the two loops. Both have the same law per axis, the same actuators and the same delay.
struct LoopCase {
  bool stable = false;          ///< on the identified model
  std::vector<double> rms;      ///< [m] per point under the disturbances; NaN: not stable
  double modulus_margin = 0.0;  ///< least singular value of I − L over all frequencies; 0: unstable
  int stable_draws = 0;         ///< of the drawn models
  double worst_margin = 0.0;    ///< over the drawn models; 0: one is unstable
  /// [m] per point, over all drawn models: those that are unstable count as infinite.
  std::vector<double> median_rms, worst_rms;
};

struct LoopTrial {
  Eigen::Index axes = 0;  ///< lowest modes, each with its own loop
  double bandwidth_hz = 0.0, delay_s = 0.0;
  std::vector<std::string> points;
  std::vector<double> open_rms;  ///< without a loop; infinite: drifts
  LoopCase on_sensors;           ///< rigid-body motion by least squares of the sensors
  LoopCase on_estimate;          ///< the estimated motion of the first point, other axes beside it
  int draws = 0;                 ///< models drawn from the covariance of the fit; 0: there is none
  std::vector<std::string> notes;
};

inline constexpr int kLoopDraws = 20;

/// Cost: for each draw the sampling of the model and the solutions of two systems of all states on
/// 60 lines and five at each resonance of the loop.
/// @throws InvalidInput  no mode lies far below the bandwidth; actuators or sensors that do not
///                       tell the axes apart; a bandwidth above a tenth of the sample rate
[[nodiscard]] LoopTrial loop_trial(const study::Study& study, const Observer& observer,
                                   stage::Work& work);

}  // namespace chladni::steps
