// Modes that a study's channels cannot see, and frequencies that its mesh cannot resolve.
#pragma once

#include <string>
#include <vector>

#include "stage/solution.h"

namespace chladni::stage {

/// Sensors and actuators in a zone or on a patch that the study keeps free.
[[nodiscard]] std::vector<std::string> channels_kept_out(const study::Study& study,
                                                         const Model& model);

/// One line per finding: flexible modes that no sensor (no actuator) sees, fewer sensors than the
/// modes for placement, and channels on the nodal line of a mode that others see. A channel is
/// blind to a mode if it sees less than 1 % of the mode's largest motion. Members of a repeated
/// mode are taken together, because their basis is arbitrary.
[[nodiscard]] std::vector<std::string> blind_spots(const study::Study& study,
                                                   const Solution& solution);

/// States the factor by which to shorten the edges, in the study or where a file of tetrahedra was
/// made, if the mesh makes a frequency more than 1 % high.
[[nodiscard]] std::vector<std::string> coarse_mesh(const Solution& solution);

/// Tells the damping ratios that the dashpots alone would give to the modes, φᵀCφ / 2ω, where they
/// are more than a tenth of those of the study: modes are those without dashpots.
[[nodiscard]] std::vector<std::string> left_out_dashpots(const Solution& solution);

}  // namespace chladni::stage
