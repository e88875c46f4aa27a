// One face of a boundary, flat or curved: its shape functions and its nearest point.
#pragma once

#include <Eigen/Core>

namespace chladni::mesh {

/// Corners or nodes of a face, one per row [m].
using FaceNodes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, 10, 3>;
using FaceValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 10, 1>;
using FaceGradient = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 10, 3>;

/// Shape functions of `order` at barycentric coordinates (the sum of 1 is not checked), and their
/// derivatives by each coordinate, with all three coordinates taken as independent.
struct FaceShape {
  FaceValues value;
  FaceGradient by_barycentric;
};
[[nodiscard]] FaceShape face_shape(int order, const Eigen::Vector3d& barycentric);

/// Barycentric coordinates, none negative, of the point of the triangle (rows: corners) nearest to
/// `point`. A degenerate triangle counts as a segment or a point.
/// Source: Ericson (2005), Real-Time Collision Detection, section 5.1.5.
[[nodiscard]] Eigen::Vector3d nearest_in_triangle(const Eigen::Matrix3d& corners,
                                                  const Eigen::Vector3d& point);

/// The nearest point on a curved face. It is found by repeated nearest points on tangent triangles.
[[nodiscard]] Eigen::Vector3d nearest_on_face(const FaceNodes& nodes, int order,
                                              const Eigen::Vector3d& point);

/// Barycentric coordinates of the point of a face vertically above or below (x, y), by Newton's
/// method where the face is curved. `found` is false where the line misses or grazes the face.
struct VerticalCrossing {
  bool found = false;
  Eigen::Vector3d barycentric;
};
[[nodiscard]] VerticalCrossing vertical_crossing(const FaceNodes& nodes, int order, bool curved,
                                                 const Eigen::Vector2d& at);

/// The largest distance of a node from its place on the flat triangle of the corners [m].
[[nodiscard]] double sag(const FaceNodes& nodes, int order);

}  // namespace chladni::mesh
