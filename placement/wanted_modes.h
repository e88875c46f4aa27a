// The modes for which devices are placed, and the noise with which they are seen.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "placement/plan.h"
#include "placement/sites.h"

namespace chladni::placement {

/// The modes for which devices are placed: m of the structure's r modes.
struct WantedModes {
  std::vector<Eigen::Index> columns;             ///< m, ascending, counted from 0
  std::vector<modal::ModeGroup> groups;          ///< of those columns
  Eigen::VectorXd rms;                           ///< m, of each mode's group [kg^-1/2]
  Eigen::VectorXd sensor_noise, actuator_noise;  ///< m [kg^-1/2]
};

/// The modes of the plan, and the other modes of their groups: a part of a repeated mode has no
/// meaning. `notes` gets a sentence for each mode that is added.
/// @param surface  where devices may be
/// @throws InvalidInput  as `require_fit`; a mode that does not exist or does not move the surface;
/// the message says
///                       which there are
[[nodiscard]] WantedModes wanted_modes(const Structure& structure, const Sites& surface,
                                       const Plan& plan, std::vector<std::string>& notes);

/// "7 (flex 1, 178.92 Hz)"; a group "10-11 (flex 4-5, 463.4 Hz)".
[[nodiscard]] std::string group_name(const Eigen::VectorXd& frequency_hz, Eigen::Index rigid_count,
                                     const WantedModes& wanted, int group);

/// Collocated sensors and actuators, by index: on one line, at most 1 mm and a hundredth of the
/// structure's size [m] beside it, and at most a twentieth of the size apart along it.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated_pairs(
    const Lines& sensors, const Lines& actuators, double size);

}  // namespace chladni::placement
