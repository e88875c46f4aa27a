// What samples teach about the coefficients of a shape, in square roots: the digits of small noise
// survive.
#pragma once

#include "base/arrays.h"

namespace chladni::placement {

/// A sample `row`·q + noise of coefficients q: from W to W' with q's covariance W Wᵀ. By Potter's
/// update (Bierman 1977, II.5): an r×r covariance itself would lose the digits of noise that is
/// 1e-8 of the motion, its root keeps them. A sample cannot be taken out again with any digits
/// left: begin anew instead. Cost: r².
/// @param row    1×r
/// @param noise  its standard deviation, more than 0
/// @param root   r×r
void learn(const Eigen::RowVectorXd& row, double noise, Eigen::MatrixXd& root);

/// The root after s samples of independent coefficients.
/// @param variance  r
/// @param rows      s×r
/// @param noise     s
[[nodiscard]] Eigen::MatrixXd root_of_posterior(const Eigen::VectorXd& variance,
                                                const Eigen::MatrixXd& rows,
                                                const Eigen::VectorXd& noise);

}  // namespace chladni::placement
