// State spaces for control as text and files.
#pragma once

#include <string>

#include "show/run.h"
#include "steps/control_models.h"

namespace chladni::show {

/// A line on the size, the delays and the reduction, and the line that MATLAB takes.
/// @param stem  name of the files without their ends: "state_space"
[[nodiscard]] std::string control_models_text(const steps::ControlModels& models,
                                              const std::string& stem);

/// Shows the text and leaves state_space.mat, state_space.json and, with a sample rate,
/// state_space.h. A model that cannot be made is a warning, and files of an earlier run go.
/// @throws Interrupted, OutOfResources
void leave_control_models(const study::Study& study, const steps::IdentifiedModel& model, Run& run);

/// The same of the simulation as simulated_state_space.*, where the study has [state_space]; else
/// files of an earlier run go.
void leave_control_models(const study::Study& study, const stage::Solution& solution, Run& run);

}  // namespace chladni::show
