// The part of a shape that moves freely: a body that heaves and tilts.
#pragma once

#include <Eigen/Core>

#include "base/arrays.h"

namespace chladni::priors {

/// q functions whose coefficients nothing is known of: 1, then linear ones. None where it is
/// default-constructed.
struct Trend {
  bool is_there = false;
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();  ///< [m]
  Eigen::Matrix3Xd slopes;                                 ///< 3×(q − 1) [1/m]

  [[nodiscard]] Eigen::Index count() const { return is_there ? 1 + slopes.cols() : 0; }
  /// n×q, 1 and about −1 to 1.
  [[nodiscard]] Eigen::MatrixXd at(const Points& points) const;
};

/// What a rigid body's motion along one `direction` looks like at the points: 1 and the coordinates
/// across the direction in which the points spread; on a line that is one, at a single point none.
/// @param direction  unit
[[nodiscard]] Trend rigid_trend(const Points& points, const Eigen::RowVector3d& direction);

}  // namespace chladni::priors
