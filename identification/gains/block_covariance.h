// Covariances of a group of modes, as the fit gives them.
#pragma once

#include "identification/gains/matching.h"

namespace chladni::identification {

/// Covariance of (L_m, R_m) of all modes of the group in sequence, with the sign of the side.
[[nodiscard]] Eigen::MatrixXd block_covariance(const Matching& state,
                                               const modal::ModeGroup& group);

/// Deviations of the entries of L R, p×q; empty if not all are known.
[[nodiscard]] Eigen::MatrixXd product_deviation(const Matching& state,
                                                const modal::ModeGroup& group);

}  // namespace chladni::identification
