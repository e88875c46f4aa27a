// The free part of a shape: the translation and tilt of a rigid body.
#pragma once

#include <Eigen/Core>

#include "base/arrays.h"

namespace chladni::priors {

/// q functions with unknown coefficients: 1, then linear ones. A
/// default-constructed trend has none.
struct Trend {
  bool is_there = false;
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();  ///< [m]
  Eigen::Matrix3Xd slopes;                                 ///< 3×(q − 1) [1/m]

  [[nodiscard]] Eigen::Index count() const { return is_there ? 1 + slopes.cols() : 0; }
  /// n×q: 1, then values of about −1 to 1.
  [[nodiscard]] Eigen::MatrixXd at(const Points& points) const;
};

/// Rigid-body motion along `direction`, seen at the points: 1, and the coordinates across the
/// direction in which the points spread (one for points on a line, none for a single point).
/// @param direction  unit
[[nodiscard]] Trend rigid_trend(const Points& points, const Eigen::RowVector3d& direction);

}  // namespace chladni::priors
