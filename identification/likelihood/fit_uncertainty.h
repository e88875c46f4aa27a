// A block model as a modal model, with the standard deviations of all it consists of.
#pragma once

#include "identification/likelihood/levenberg.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Covariance (2 JᵀJ)⁻¹ of circular noise, times noise_level and variance_factor; directions that
/// change nothing (the scale between L and R, the basis of the rigid-body modes) are held still.
/// Blocks that stayed together become modes of one group. Cost: one set of normal equations and the
/// inverse of their matrix.
[[nodiscard]] ModalFit with_uncertainty(const Descent& found, const Target& target,
                                        const Fitted& fitted, const FitData& data, Damping damping);

/// Of what no data speak nothing is known: infinite deviations of the residuals, shapes and
/// rigid-body rows of channels without a measured response.
/// @param weight  p×q: of each response, 0 where it is not measured
void mark_unmeasured(const Eigen::MatrixXd& weight, ModalFit& fit);

}  // namespace chladni::identification
