// An identified model in the scale of its match, and its delays: parts of models for control.
#pragma once

#include <vector>

#include "identification/gain_match.h"
#include "identification/modal_fit.h"
#include "modal/control_model.h"

namespace chladni::identification {

/// L T and T⁻¹ R with the T that brings R next to the matched input shapes with the signs of the
/// data (driving_shapes), so that the outputs are next to the matched shapes: a number for each
/// mode, a matrix for all modes at 0 Hz together. The responses stay those of the fit.
[[nodiscard]] modal::ReducedModel in_scale_of(const GainMatch& match, modal::ReducedModel model);

/// The same for complex shapes: T is complex there, for each mode above 0 Hz.
[[nodiscard]] ComplexShapes in_scale_of(const GainMatch& match, const ModalFit& fit,
                                        const ComplexShapes& shapes);

/// Position and velocity of each rigid-body mode, then two states of each complex mode without a
/// name of their own.
[[nodiscard]] std::vector<modal::Signal> complex_states(const modal::ReducedModel& model);

/// Delays of the inputs and outputs as the fit has them; those below 0 are 0.
void set_delays(const ModalFit& fit, modal::ControlModel& model);

}  // namespace chladni::identification
