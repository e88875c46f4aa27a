// An identified model as a state space for the design of a controller.
#pragma once

#include <string>
#include <vector>

#include "identification/gain_match.h"
#include "identification/modal_fit.h"
#include "modal/control_model.h"
#include "modal/frf_set.h"

namespace chladni::identification {

/// From the actuators to the sensors, each in its own quantity; a displacement whose file states no
/// unit has none. Delays of outputs are output
/// delays, others input delays; a delay below 0 is left out, because no model looks ahead. With
/// real shapes the states are modal coordinates of mass-normalised shapes, in the scale of `match`:
/// C(ρ) at a place is φ(ρ) over the scale of the positions. The responses are those of the fit:
/// what the match corrects of single channels is not in them.
/// @param outputs, inputs  the channels of the fit
/// @throws InvalidInput  the numbers of channels differ
[[nodiscard]] modal::ControlModel control_model(const ModalFit& fit, const GainMatch& match,
                                                const std::vector<modal::MeasuredChannel>& outputs,
                                                const std::vector<modal::MeasuredChannel>& inputs);

/// Differences between this state space and the fit, a sentence each: a delay below 0 by more than
/// two of its deviations (or by anything where the fit states none), the flexibility of the modes
/// above the band where a sensor measures velocity or acceleration, what the sum of complex shapes
/// adds to an acceleration in proportion to the frequency.
[[nodiscard]] std::vector<std::string> left_out_of_control_model(
    const ModalFit& fit, const std::vector<modal::MeasuredChannel>& outputs);

}  // namespace chladni::identification
