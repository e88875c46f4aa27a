// Distance of a fitted model from the structure, where the data are better than was stated.
#pragma once

#include "identification/fit_data.h"

namespace chladni::identification {

/// The relative model error ε of each line, K, between 0 and `most`: the residual of a fit beyond
/// the noise, divided by the size of the responses, over all responses and 12 lines on both sides.
/// It varies between lines: if the structure's damping is not modal, real modes fit each resonance
/// to a different part. Cost: K pq.
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
