// A study's structure at its sensors and actuators.
#pragma once

#include "modal/reduced_model.h"
#include "stage/solution.h"

namespace chladni::stage {

/// The study's sensors and actuators on the first `mode_count` modes of its solution (0: all), the
/// static flexibility of all the others, and its dashpots. Cost: one factorisation and some
/// five solves per actuator.
/// @throws InvalidInput  more modes are asked for than there are; as fem::reduced
[[nodiscard]] modal::ReducedModel at_channels(const study::Study& study, const Solution& solution,
                                              Eigen::Index mode_count = 0);

/// The same on all modes, with further outputs below those of the sensors: the displacement at each
/// actuator along its direction.
[[nodiscard]] modal::ReducedModel at_channels_and_drives(const study::Study& study,
                                                         const Solution& solution);

}  // namespace chladni::stage
