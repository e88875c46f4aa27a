// Turns a general block into a mode with complex shapes and its deviations.
#pragma once

#include <Eigen/Core>

#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// L and R with the rules of ComplexShapes, in physical units.
struct GeneralMode {
  double omega = 0.0, damping_ratio = 0.0;  ///< omega [rad/s]
  Eigen::VectorXcd outputs;
  Eigen::RowVectorXcd inputs;
  Eigen::MatrixXd covariance;  ///< of (ω, ζ, Re L, Re R, Im L, Im R)
};

/// The block with the phase and the sign of L and R that ComplexShapes requires.
[[nodiscard]] Block turned(const Block& block);

/// @param block       general, `turned`
/// @param scale       of the model [rad/s]
/// @param covariance  of the block's parameters in the order of NormalEquations; its part along the
///                    complex factor between both sides is removed
[[nodiscard]] GeneralMode general_mode_of(const Block& block, double scale,
                                          const Eigen::MatrixXd& covariance);

}  // namespace chladni::identification
