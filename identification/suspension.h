// Modes above 0 Hz in which the body moves rigidly on its suspension.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/modal_fit.h"

namespace chladni::identification {

struct Suspension {
  std::vector<Eigen::Index> modes;  ///< the lowest modes of the fit
  /// Possible distance of their shapes from rigid motion, relative to the shape's rms:
  /// (f / f₁)² of the highest of them, with f₁ the lowest bending mode. If the fit shows more,
  /// that value counts.
  double bending = 0.0;
};

/// Finds the lowest modes above 0 Hz that are rigid motions, at most as many as there are motions.
/// Their shape, at the side with more channels, is a rigid motion within a fifth of its rms, and
/// they lie below a third of the next mode. A side with no more channels than motions tells nothing
/// about a shape; channels that were not measured do not count. Empty where the body is free (modes
/// at 0 Hz) or the data do not tell.
/// @param outputs, inputs  p×r and q×r, as rigid_directions gives them
[[nodiscard]] Suspension suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                                    const Eigen::MatrixXd& inputs);

/// The lowest `count` modes above 0 Hz, whatever their shapes are.
/// @throws InvalidInput  fewer such modes exist, or `count` is above the number of motions
[[nodiscard]] Suspension stated_suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                                           const Eigen::MatrixXd& inputs, Eigen::Index count);

}  // namespace chladni::identification
