// The view of a body. Pictures and the report use the same view.
#pragma once

#include <Eigen/Core>

#include "base/arrays.h"

namespace chladni::io {

/// The orientation of the body on the table, and the direction of the eye.
struct Pose {
  Eigen::Matrix3d frame;  ///< rows: the body's directions to the right, away and up (axes)
  double yaw = 0.0;       ///< rotation of the eye about "up", from straight in front [rad]
  double pitch = 0.0;     ///< height of the eye over the table [rad]
};

/// The pose of `points` (N×3). The thinnest direction points up (z where none is clearly thinner);
/// the longest of the other directions points to the right. A slim body is seen more from the
/// front.
[[nodiscard]] Pose pose_of(const Points& points);

/// A parallel projection onto the paper.
struct View {
  Eigen::Matrix3d axes;    ///< rows: to the right, up, towards the eye
  Eigen::Vector3d centre;  ///< this point is in the middle [m]
  double pixels_per_metre = 1.0;

  /// The place of `point` relative to the middle, y downwards [px].
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector3d& point) const;
  /// Width and height of the box around `points` (N×3) on the paper [px].
  [[nodiscard]] Eigen::Vector2d extent(const Points& points) const;
};

/// The view of a body in its pose at one pixel per metre, centred on `points`.
[[nodiscard]] View view_of(const Points& points);

}  // namespace chladni::io
