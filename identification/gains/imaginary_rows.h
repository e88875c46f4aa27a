// Imaginary parts of complex shapes on the scale that gain_match found.
#pragma once

#include "identification/gains/matching.h"

namespace chladni::identification {

/// The data leave a phase open between both sides of a complex mode: that at which the pairs at one
/// place agree best. The fit's shapes, real parts and covariances are turned by it; nothing where
/// the shapes are real.
void agree_in_phase(Matching& state);

/// Fills GainMatch::imaginary and input_imaginary from the fit's complex shapes, on the scale of
/// the real parts; nothing where the shapes are real. @pre the rows are gathered
void add_imaginary_rows(Matching& state);

}  // namespace chladni::identification
