// How a body is looked at, in pictures and in the report: the same way in both.
#pragma once

#include <Eigen/Core>

#include "base/arrays.h"

namespace chladni::io {

/// The body as it lies on the table, and from where the eye looks at it.
struct Pose {
  Eigen::Matrix3d frame;  ///< rows: the body's directions to the right, away and up (axes)
  double yaw = 0.0;       ///< turn of the eye about "up", from straight in front [rad]
  double pitch = 0.0;     ///< height of the eye over the table [rad]
};

/// The thinnest direction of `points` (N×3) points up, z where none is clearly thinner; the longest
/// of the others to the right. A slim body is seen more from the front.
[[nodiscard]] Pose pose_of(const Points& points);

/// Where a point falls on the paper, in a parallel view.
struct View {
  Eigen::Matrix3d axes;    ///< rows: to the right, up, towards the eye
  Eigen::Vector3d centre;  ///< falls onto the middle [m]
  double pixels_per_metre = 1.0;

  /// Where `point` falls, from the middle, y downwards [px].
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector3d& point) const;
  /// Width and height of the box around `points` (N×3) on the paper [px].
  [[nodiscard]] Eigen::Vector2d extent(const Points& points) const;
};

/// The view of a body in its pose at one pixel per metre, centred on `points`.
[[nodiscard]] View view_of(const Points& points);

}  // namespace chladni::io
