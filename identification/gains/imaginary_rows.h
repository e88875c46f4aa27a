// Imaginary parts of complex shapes on the scale that gain_match found.
#pragma once

#include "identification/gains/matching.h"

namespace chladni::identification {

/// The data do not determine the phase between both sides of a complex mode. This function takes
/// the phase at which the pairs at one place agree best, and turns the fit's shapes, real parts and
/// covariances by it. It does nothing for real shapes.
void agree_in_phase(Matching& state);

/// Fills GainMatch::imaginary and input_imaginary from the fit's complex shapes, in the scale of
/// the real parts. It does nothing for real shapes. @pre the rows are gathered
void add_imaginary_rows(Matching& state);

}  // namespace chladni::identification
