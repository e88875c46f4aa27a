// K and M of a study with all that another program needs to solve them.
#pragma once

#include <string>

#include "io/json.h"
#include "show/run.h"
#include "stage/solution.h"

namespace chladni::show {

/// The folder `system` of the run: stiffness, mass and, where there are dashpots, damping as .petsc
/// and .mtx, rows.csv, rigid.mtx, channels.csv, sensors.mtx (C, a row per sensor), actuators.mtx
/// (B, a column per actuator) and solve.py (docs/reference/cluster.md). It appears whole or not at
/// all, and takes the place of an older one.
/// @throws OutOfResources  the disk is full
void leave_system(const study::Study& study, const stage::Solution& solution, Run& run);

/// Sizes of the matrices.
[[nodiscard]] io::JsonObject export_json(const stage::Solution& solution);

/// "30000 degrees of freedom, ..." and the folder.
[[nodiscard]] std::string export_text(const stage::Solution& solution, const Run& run);

}  // namespace chladni::show
