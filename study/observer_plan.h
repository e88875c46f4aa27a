// [observer] of a study: an estimate of the motion where no sensor is.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/place.h"

namespace chladni::study {

/// A point whose motion is estimated.
struct ObservedPoint {
  std::string name;
  Place at;
  std::optional<Eigen::Vector3d> direction;  ///< unit; none: that of the interpolation
};

/// A random disturbance that nobody measures.
struct DisturbancePlan {
  std::string name;
  std::string kind;  ///< "actuators": at each of them; "force": at a place; "floor": acceleration
  std::vector<std::string> actuators;        ///< of kind "actuators"; empty: all
  Place at;                                  ///< of kind "force"
  std::optional<Eigen::Vector3d> direction;  ///< of kind "force": unit; none: as of a point
  double rms = 0.0;                          ///< [N], [m/s²]; of a drift that of its change
  double density = 0.0;                      ///< [N²/Hz], [m²/s⁴/Hz], one-sided; instead of rms
  double low_hz = 0.0, high_hz = 0.0;        ///< its band; high 0: up to half of the sample rate
  double drift_time = 0.0;                   ///< [s] in which it changes by rms; 0: no drift
};

/// A loop on the estimate, beside one on the sensors.
struct ObserverLoopPlan {
  std::vector<std::string> actuators;  ///< that it drives
  double bandwidth_hz = 0.0;
  double delay = 0.0;  ///< [s] of the computer; at least one sample
};

struct ObserverPlan {
  double sample_rate_hz = 0.0;   ///< 0: that of the recordings, the state space or the experiment
  double noise = 0.0;            ///< rms of every sensor, in its SI unit; 0: from the recordings
  std::filesystem::path replay;  ///< recordings; empty: those of [measurement]
  std::filesystem::path truth;   ///< a study whose model the true structure has; or empty
  bool learn_noise = true;       ///< factors on the noise and the disturbances from the recordings
  double settle = 0.0;           ///< [s] of each recording that no score counts; 0: found
  std::vector<ObservedPoint> points;
  std::vector<DisturbancePlan> disturbances;
  std::optional<ObserverLoopPlan> loop;
};

}  // namespace chladni::study
