// Sites: places on the surface of a body for sensors, actuators or attachments.
#pragma once

#include <memory>
#include <optional>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {

/// A point of the boundary. Values at this point are interpolated from the face's nodes.
struct Site {
  Eigen::VectorXi nodes;     ///< nodes of the face: 3, 6 or 10
  Eigen::VectorXd weights;   ///< the face's shape functions at the point; they sum to 1
  Eigen::Vector3d position;  ///< [m]
  Eigen::Vector3d normal;    ///< outward, unit
  Eigen::Index face = -1;    ///< row of TetMesh::faces
  double distance = 0.0;     ///< from the given point or the given vertical line [m]
};

/// Finds sites with a search tree of the faces. The mesh must outlive the finder. On curved faces
/// (nodes off the plane of the corners) sites lie on the curved face, not on the plane.
/// @throws InvalidInput  the mesh has no boundary faces; a given point is not finite
class SiteFinder {
 public:
  explicit SiteFinder(const TetMesh& mesh);
  ~SiteFinder();
  SiteFinder(const SiteFinder&) = delete;
  SiteFinder& operator=(const SiteFinder&) = delete;
  SiteFinder(SiteFinder&&) noexcept;
  SiteFinder& operator=(SiteFinder&&) noexcept;

  /// The nearest point of the boundary. Cost: logarithmic in the faces.
  [[nodiscard]] Site nearest(const Eigen::Vector3d& point) const;

  /// The highest point of the boundary on the vertical line through (x, y); none where the line
  /// misses the body. Lines through edges and corners count as hits. Cost: logarithmic in the
  /// faces.
  [[nodiscard]] std::optional<Site> from_above(double x, double y) const;

  /// The point of the boundary nearest to the vertical line through (x, y), measured level; the
  /// highest of several, on a face that looks up where there is one. `distance` is that to the
  /// line. Cost: as from_above.
  [[nodiscard]] Site beside(double x, double y) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The row that gives the displacement along `direction` (unit) at `site`. For shapes of 3·nodes
/// rows, x0 y0 z0 x1 ..., the displacement is row · shapes.
/// @throws InvalidInput  direction is not a unit vector, or a node of the site is not below
///                       node_count
[[nodiscard]] Eigen::SparseVector<double> row_at(const Site& site, const Eigen::Vector3d& direction,
                                                 Eigen::Index node_count);

/// Shape functions of a triangle of `order` 1, 2 or 3 at barycentric coordinates (l0, l1, l2), in
/// VTK's order; they sum to 1. @throws InvalidInput  another order
[[nodiscard]] Eigen::VectorXd triangle_shape(int order, const Eigen::Vector3d& barycentric);

}  // namespace chladni::mesh
