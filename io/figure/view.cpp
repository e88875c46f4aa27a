#include "io/figure/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/surface.h"

namespace chladni::io {
namespace {

Eigen::Matrix3d body_frame(const Eigen::Vector3d& extent) {
  Eigen::Index up = 2;
  for (const Eigen::Index axis : {0, 1}) {
    if (extent(axis) < 0.7 * extent(up)) up = axis;
  }
  Eigen::Index right = up == 0 ? 1 : 0;
  const Eigen::Index other = 3 - up - right;
  if (extent(other) > 1.2 * extent(right)) right = other;
  Eigen::Matrix3d frame = Eigen::Matrix3d::Zero();
  frame(0, right) = 1.0;
  frame(2, up) = 1.0;
  frame.row(1) = frame.row(2).cross(frame.row(0));
  return frame;
}

}  // namespace

Pose pose_of(const Points& points) {
  const auto box = mesh::bounding_box(points);
  const Eigen::Vector3d extent = (box.row(1) - box.row(0)).transpose();
  Pose pose;
  pose.frame = body_frame(extent);
  const Eigen::Vector3d size = (pose.frame * extent).cwiseAbs();
  const double slimness = size(0) / std::max(size(1), 1e-300);
  constexpr double degree = std::numbers::pi / 180.0;
  pose.yaw = -28.0 * degree * std::clamp(2.0 / slimness, 0.4, 1.0);
  pose.pitch = 36.0 * degree;
  return pose;
}

Eigen::Vector2d View::at(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = pixels_per_metre * (axes * (point - centre));
  return {seen.x(), -seen.y()};
}

Eigen::Vector2d View::extent(const Points& points) const {
  const auto seen = (points * axes.topRows<2>().transpose()).eval();
  return pixels_per_metre * (seen.colwise().maxCoeff() - seen.colwise().minCoeff()).transpose();
}

View view_of(const Points& points) {
  const Pose pose = pose_of(points);
  const double cy = std::cos(pose.yaw), sy = std::sin(pose.yaw);
  const double cp = std::cos(pose.pitch), sp = std::sin(pose.pitch);
  Eigen::Matrix3d turn;
  turn << cy, sy, 0.0, -sy * sp, cy * sp, cp, sy * cp, -cy * cp, sp;
  const auto box = mesh::bounding_box(points);
  View view;
  view.axes = turn * pose.frame;
  view.centre = 0.5 * (box.row(0) + box.row(1)).transpose();
  return view;
}

}  // namespace chladni::io
