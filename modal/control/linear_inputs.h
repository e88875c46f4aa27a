// Inputs that are measured at samples and go straight from one to the next.
#pragma once

#include <Eigen/Core>

#include "modal/control_model.h"

namespace chladni::modal {

/// The continuous model under the rates of its first `known` inputs: an integrator for each, behind
/// its states. Held rates are straight lines.
[[nodiscard]] ControlModel under_rates(const ControlModel& model, Eigen::Index known);

/// Makes the inputs themselves of the rates, `model` being such a model sampled, with delays of
/// outputs as states: u of a sample and of the next one give the rate between them, and neither the
/// integrators nor the last rates are states. x at a sample depends on u of the same one; the
/// states are x − `ahead` u, whose next value does not (as those of a triangle hold: Franklin,
/// Powell and Workman 1998, 6.3.2).
/// @param first     of the integrators among the states; the last rates follow
/// @param fraction  of a sample that each input is late: with one above 0 there is a last rate
/// @return `ahead`, n×known
[[nodiscard]] Eigen::MatrixXd take_inputs_of_rates(Eigen::Index first,
                                                   const Eigen::VectorXd& fraction,
                                                   ControlModel& model);

}  // namespace chladni::modal
