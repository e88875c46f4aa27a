// A general block as a mode with complex shapes, and what its deviations are.
#pragma once

#include <Eigen/Core>

#include "identification/likelihood/block_model.h"

namespace chladni::identification {

/// L and R as ComplexShapes has them, in physical units.
struct GeneralMode {
  double omega = 0.0, damping_ratio = 0.0;  ///< omega [rad/s]
  Eigen::VectorXcd outputs;
  Eigen::RowVectorXcd inputs;
  Eigen::MatrixXd covariance;  ///< of (ω, ζ, Re L, Re R, Im L, Im R)
};

/// The block with the phase and the sign of its L and R as ComplexShapes fixes them.
[[nodiscard]] Block turned(const Block& block);

/// @param block       general, `turned`
/// @param scale       of the model [rad/s]
/// @param covariance  of its parameters in the order of NormalEquations; whatever moves it along
/// the
///                    complex factor between both sides is taken out
[[nodiscard]] GeneralMode general_mode_of(const Block& block, double scale,
                                          const Eigen::MatrixXd& covariance);

}  // namespace chladni::identification
