// Deviations of the parameters from the normal equations of a block model. Used in this room only.
#pragma once

#include <Eigen/Core>

#include "identification/likelihood/normal_equations.h"
#include "identification/likelihood/uncertainty/untold.h"

namespace chladni::identification {

using Unknown = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// Covariance of n parameters, n×n; zero rows and columns for unknown parameters.
struct Covariance {
  Eigen::MatrixXd matrix;
  Unknown unknown;  ///< n: no data determine the parameter, or a bound holds it
  /// n: variance of a parameter that a bound holds, if nothing held it: more than it has beyond the
  /// bound. 0 for the other parameters, infinite where no data determine it.
  Eigen::VectorXd held_variance;
};

/// n×d: parameter directions that change no measured response. Where the channels are two parts or
/// more, each part has those of its own.
[[nodiscard]] Eigen::MatrixXd idle_directions(const BlockModel& model, Eigen::Index parameters,
                                              const Parts& parts);

/// Pseudo-inverse of the normal equations. It keeps the idle directions still: the result is
/// orthogonal to them in the parameters' own metric. Unknown are: parameters that change no
/// response, the damping of undamped modes, and parameters with a share of a hundredth or more in a
/// direction below double precision (1e-13 of a scaled eigenvalue). The deviations of the others
/// hold for given values of the unknown ones. A parameter whose own sum is not finite is unknown.
/// Cost: n³, ten times that where there are such directions.
/// @throws NumericalFailure  the equations of the other parameters are not finite
[[nodiscard]] Covariance held_inverse(const BlockModel& model, const NormalEquations& normal,
                                      const Eigen::MatrixXd& idle);

}  // namespace chladni::identification
