// The body that moves as a whole: its mass properties, and how channels and rigid-body motion go
// into each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/decoupling.h"
#include "identification/rigid_properties.h"
#include "steps/identification.h"

namespace chladni::steps {

struct RigidBodyOfChannels {
  Eigen::Index modes = 0;               ///< in which the body moves as a whole
  std::vector<Eigen::Index> suspended;  ///< those above 0 Hz
  std::optional<identification::RigidProperties> properties;  ///< none: the notes say why
  Eigen::Vector3d about;        ///< point of moments and displacements [m]
  bool up_to_a_factor = false;  ///< mass and inertia: the file states no unit of a sensor
  identification::Decoupling sensors, actuators;  ///< about `about`
  /// Names of the channels that the matrices have columns and rows for.
  std::vector<std::string> sensor_names, actuator_names;
  std::vector<std::string> notes;  ///< what is missing and why, a sentence each
};

/// None if a channel has no place or direction.
[[nodiscard]] std::optional<RigidBodyOfChannels> rigid_body_of_channels(
    const study::Study& study, const IdentifiedModel& model);

}  // namespace chladni::steps
