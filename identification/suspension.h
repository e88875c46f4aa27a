// Which modes above 0 Hz are the body moving as a whole on its suspension.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/modal_fit.h"

namespace chladni::identification {

struct Suspension {
  std::vector<Eigen::Index> modes;  ///< of the fit, the lowest ones
  /// How far their shapes may be from a motion as a whole, a part of the shape's rms: (f / f₁)² of
  /// the highest of them, f₁ the lowest bending mode, or what the fit shows where that is more.
  double bending = 0.0;
};

/// The lowest modes above 0 Hz, as many as there are motions at most, whose shape at the side with
/// more channels is such a motion within a fifth of its rms, and that lie below a third of the next
/// mode. A side with no more channels than motions says nothing of a shape. Empty where the body
/// moves freely (modes at 0 Hz), or nothing tells.
/// @param outputs, inputs  p×r and q×r, as rigid_directions gives them
[[nodiscard]] Suspension suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                                    const Eigen::MatrixXd& inputs);

/// The lowest `count` modes above 0 Hz, whatever their shapes are.
/// @throws InvalidInput  there are fewer of them, or more are asked for than there are motions
[[nodiscard]] Suspension stated_suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                                           const Eigen::MatrixXd& inputs, Eigen::Index count);

}  // namespace chladni::identification
