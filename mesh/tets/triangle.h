// One face of a boundary, flat or curved: its shape functions and its nearest point.
#pragma once

#include <Eigen/Core>

namespace chladni::mesh {

/// Corners or nodes of a face, one per row [m].
using FaceNodes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, 10, 3>;
using FaceValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 10, 1>;
using FaceGradient = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 10, 3>;

/// Shape functions of `order` at barycentric coordinates (not checked to sum to 1), and their
/// derivatives by each coordinate as if it were free.
struct FaceShape {
  FaceValues value;
  FaceGradient by_barycentric;
};
[[nodiscard]] FaceShape face_shape(int order, const Eigen::Vector3d& barycentric);

/// Barycentric coordinates, none negative, of the point of the triangle (rows: corners) nearest to
/// `point`; of a segment or a point where the triangle is degenerate.
/// Source: Ericson (2005), Real-Time Collision Detection, section 5.1.5.
[[nodiscard]] Eigen::Vector3d nearest_in_triangle(const Eigen::Matrix3d& corners,
                                                  const Eigen::Vector3d& point);

/// The same on a curved face: nearest points of tangent triangles, until they stand still.
[[nodiscard]] Eigen::Vector3d nearest_on_face(const FaceNodes& nodes, int order,
                                              const Eigen::Vector3d& point);

/// Barycentric coordinates of the point of a face straight above or below (x, y), by Newton's
/// method where the face is curved. `found` is false where the line misses it or grazes it.
struct VerticalCrossing {
  bool found = false;
  Eigen::Vector3d barycentric;
};
[[nodiscard]] VerticalCrossing vertical_crossing(const FaceNodes& nodes, int order, bool curved,
                                                 const Eigen::Vector2d& at);

/// How far the nodes lie off the flat triangle of the corners, at most [m].
[[nodiscard]] double sag(const FaceNodes& nodes, int order);

}  // namespace chladni::mesh
