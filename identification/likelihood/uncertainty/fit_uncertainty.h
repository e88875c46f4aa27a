// Turns a block model into a modal model with standard deviations of all its parts.
#pragma once

#include "identification/likelihood/levenberg.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Covariance (2 JᵀJ)⁻¹ for circular noise, times noise_level and variance_factor. Directions that
/// change no response (the scale between L and R, the basis of the rigid-body modes) are held
/// still. Neighbouring modes with hardly known shapes form one group. Cost: one set of normal
/// equations and the inverse of their matrix.
[[nodiscard]] ModalFit with_uncertainty(const Descent& found, const Target& target,
                                        const Fitted& fitted, const FitData& data, Damping damping);

}  // namespace chladni::identification
