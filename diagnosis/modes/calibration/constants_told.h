// What is told of calibrated constants.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/modes/calibration/constants_held.h"

namespace chladni::diagnosis {

/// Sets the constants of a diagnosis and the strong correlations, and notes what these data cannot
/// tell apart.
/// @param x           their coordinates, c
/// @param covariance  of these, c×c
void tell_constants(const std::vector<HeldConstant>& constants, const Eigen::VectorXd& x,
                    const Eigen::MatrixXd& covariance, Diagnosis& diagnosis);

}  // namespace chladni::diagnosis
