// Constants of a study in fits of responses: deviations with the width that was stated.
#pragma once

#include <vector>

#include "diagnosis/fit/fit.h"
#include "diagnosis/modes/calibration/constants_held.h"

namespace chladni::diagnosis {

/// ln of each constant over the study's where the fits start; 0 where `start` does not determine
/// it.
[[nodiscard]] Eigen::VectorXd start_of(const std::vector<HeldConstant>& constants,
                                       const std::vector<CalibratedNumber>& start);

/// A deviation for each constant: eta of its widths from `start`. The structure must outlive them.
[[nodiscard]] std::vector<Deviation> constant_deviations(const Structure& structure,
                                                         const std::vector<HeldConstant>& constants,
                                                         const Eigen::VectorXd& start);

/// Constants and their covariance in a fit.
struct FittedConstants {
  Eigen::VectorXd x;           ///< c: ln of each over the study's
  Eigen::MatrixXd covariance;  ///< c×c
};
/// @param first  index of the first constant among the deviations
[[nodiscard]] FittedConstants constants_of(const Fit& fit,
                                           const std::vector<HeldConstant>& constants,
                                           const Eigen::VectorXd& start, Eigen::Index first);

}  // namespace chladni::diagnosis
