// Modes in universal files, for other programs: on the body, at channels, between channels.
#pragma once

#include "io/modes_uff.h"
#include "show/run.h"
#include "stage/solution.h"
#include "steps/identification.h"
#include "steps/interpolation.h"

namespace chladni::show {

/// The simulated modes at the corners of the body's faces, numbered from 1 in the mesh's order.
[[nodiscard]] io::UffModes body_modes_uff(const study::Study& study,
                                          const stage::Solution& solution);

/// The identified shapes at the sensors, and at the actuators without a sensor at their place. A
/// channel has its `node`; channels at one place (within 1e-9 m) share a node, and channels without
/// one get the lowest free numbers in their order. The motion of a node with fewer than three
/// directions is the shortest that its channels see; of more channels, the one of least squares.
/// A mode has no record of a node where it does not know the motion along one of its channels. A
/// mode without a scale between both sides is known at the sensors alone.
[[nodiscard]] io::UffModes channel_modes_uff(const study::Study& study,
                                             const steps::IdentifiedModel& model);

/// The interpolated shapes on the surface, of the method that is shown: along the wanted direction,
/// or along the normals.
[[nodiscard]] io::UffModes surface_modes_uff(const study::Study& study,
                                             const steps::Interpolated& result);

/// Writes modes.unv, identified.unv or mode_field.unv where the study asks for it; else one of an
/// earlier run is removed. @throws as io::modes_uff and write_atomically
void leave_modes_uff(const study::Study& study, const stage::Solution& solution, const Run& run);
void leave_modes_uff(const study::Study& study, const steps::IdentifiedModel& model, Run& run);
void leave_modes_uff(const study::Study& study, const steps::Interpolated& result, const Run& run);

}  // namespace chladni::show
