// How far a fitted model is from the structure, where the data know better than what was stated.
#pragma once

#include "identification/fit_data.h"

namespace chladni::identification {

/// The relative model error ε of each line, K, between 0 and `most`: what a fit leaves of the
/// responses beyond their noise, over their size, within 12 lines on both sides and all responses.
/// Real modes fit a structure of other damping to one part at one resonance and to another at the
/// next. Cost: K pq.
/// @param noise_only  weights 1/σ of the noise alone
/// @param fitted      K×pq
[[nodiscard]] Eigen::VectorXd remaining_model_error(const FitData& noise_only,
                                                    const Eigen::MatrixXcd& fitted, double most);

/// The same data with σ² + (ε |Ĝ|)² instead of the noise alone.
/// @param fitted  K×pq
/// @param model_error  K
[[nodiscard]] FitData with_model_error(const FitData& noise_only, const Eigen::MatrixXcd& fitted,
                                       const Eigen::VectorXd& model_error);

}  // namespace chladni::identification
