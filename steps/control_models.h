// State spaces of a study's model for the design and the running of a controller.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "modal/control_model.h"
#include "steps/identification.h"

namespace chladni::steps {

struct ControlModels {
  modal::ControlModel continuous;               ///< reduced, and its delays Padé, where asked for
  std::optional<modal::ControlModel> discrete;  ///< with a sample rate alone
  Eigen::Index kept_states = 0;  ///< after a reduction, before Padé states are added
  Eigen::Index all_states = 0;   ///< before a reduction
  Eigen::VectorXd hankel;        ///< of the stable part, descending; empty: not computed
  double error_bound = 0.0;      ///< of the largest singular value of the reduction's error
  /// q_m = position_m x_2m: modal coordinates from states of modes; empty where the states are
  /// reduced, or shapes are complex.
  std::vector<double> position;
  std::vector<std::string> notes;  ///< differences from the model, a sentence each
};

/// As [state_space] of the study says.
/// @throws InvalidInput  a number of states that the model does not have, an undamped mode beside a
///                       reduction, a delay of too many samples; the message names the study
[[nodiscard]] ControlModels control_models(const study::Study& study,
                                           const modal::ControlModel& whole);

/// From the study's actuators to its sensors on the modes of its simulation, with the static
/// flexibility of all others. Cost: that of stage::at_channels.
/// @throws InvalidInput  as above; no sensor or no actuator
[[nodiscard]] ControlModels control_models(const study::Study& study,
                                           const stage::Solution& solution);

/// From the actuators to the sensors of an identified model.
[[nodiscard]] ControlModels control_models(const study::Study& study, const IdentifiedModel& model);

}  // namespace chladni::steps
