// What a study's channels cannot see of its modes, and what its mesh cannot tell.
#pragma once

#include <string>
#include <vector>

#include "app/stage/solution.h"

namespace chladni::app {

/// Sensors and actuators that lie in a zone or on a patch the study keeps free.
[[nodiscard]] std::vector<std::string> channels_kept_out(const Study& study, const Model& model);

/// Flexible modes that no sensor (no actuator) sees, fewer sensors than the modes that placement
/// asks for, and channels that lie on the nodal line of a mode others see: one line per finding. A
/// channel is blind to a mode where it sees less than 1 % of the mode's largest motion; members of
/// a repeated mode are taken together, as their basis is arbitrary.
[[nodiscard]] std::vector<std::string> blind_spots(const Study& study, const Solution& solution);

/// Says by which factor to shorten the edges where the mesh leaves a frequency more than 1 % high.
[[nodiscard]] std::vector<std::string> coarse_mesh(const Solution& solution);

}  // namespace chladni::app
