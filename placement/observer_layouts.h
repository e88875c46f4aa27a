// The layout of sensors, actuators and collocated pairs whose observer knows a region best.
#pragma once

#include <vector>

#include "base/arrays.h"
#include "placement/observer_model.h"

namespace chladni::placement {

enum class DeviceKind { sensor, actuator, pair };

/// How many devices of each kind are to be chosen.
struct DeviceCounts {
  int sensors = 0, actuators = 0, pairs = 0;

  [[nodiscard]] int all() const { return sensors + actuators + pairs; }
  [[nodiscard]] bool only_sensors() const { return actuators == 0 && pairs == 0; }
};

/// Choose devices among N candidates, beside s sensors and a actuators that are there. What is
/// least:
/// - of sensors alone the variance of the estimate of z, ObserverValue::estimate;
/// - else the cost of the best loop, ObserverValue::loop: an actuator brings its disturbance and
/// the
///   force of the loop, a sensor what the loop knows. Without any sensor all states are known.
/// One place has one device; a pair is a sensor and an actuator in one place.
struct ObserverProblem {
  ObserverTask task;
  Eigen::MatrixXd rows;       ///< N×r [kg^-1/2]
  Eigen::MatrixXd sensors;    ///< s×r, there
  Eigen::MatrixXd actuators;  ///< a×r, there
  DeviceCounts counts;
  Points position;  ///< N×3 [m]; may be empty if spacing is 0 and N at most 2 Constants::coarse
  double spacing = 0.0;  ///< [m], least distance between two chosen devices
};

struct PlacedDevice {
  DeviceKind kind = DeviceKind::sensor;
  Eigen::Index site = -1;  ///< row of the candidates
};

struct ObserverChoice {
  std::vector<PlacedDevice>
      devices;          ///< pairs, then actuators, then sensors, each by ascending site
  ObserverValue value;  ///< by the Riccati equation
  /// No move of one device to another place among the candidates gains more than 1e-9 of the cost;
  /// false where only a part of them was tried, or where the rounds of exchange came to an end.
  bool swap_optimal = false;
  int layouts = 0;  ///< that were scored
};

struct ObserverOptions {
  int starts = 4;  ///< the greedy one, then ones that are half random
  unsigned seed = 1;
};

/// Greedy, then exchange: each device in turn goes to the best place beside the others, and two of
/// different kinds trade places or go elsewhere together, until a round brings nothing. Every
/// layout on the way is scored by its own Riccati equation, solved by doubling; the last one by
/// SLICOT, which must agree. There is no bound: in steady state the variance is neither submodular
/// (Zhang, Ayoub and Sundaram 2017) nor convex in the sensors, so that greedy may be far from the
/// best; exchange mends some of it. With more than Constants::coarse candidates the search is on
/// that many, then about the chosen ones.
/// Cost: per layout some 15 doublings of 17 n³ for n states, twice in a loop; one round scores N
/// layouts per device.
/// @throws InvalidInput      as ObserverModel; no device, or fewer candidates than devices (or the
///                           spacing leaves too few); a loop without effort; a disturbance at
///                           actuators alone without an actuator; not one position per candidate
/// @throws NumericalFailure  doubling and SLICOT differ
[[nodiscard]] ObserverChoice best_observer(const ObserverProblem& problem,
                                           const ObserverOptions& options = {});

/// The value of some devices beside what is there.
[[nodiscard]] ObserverValue observer_value(const ObserverProblem& problem,
                                           const std::vector<PlacedDevice>& devices);

/// What the search makes small [m²].
[[nodiscard]] double cost_of(const ObserverProblem& problem, const ObserverValue& value);

}  // namespace chladni::placement
