// Places on a body's surface where a device may be, and what it sees of the modes there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/arrays.h"
#include "mesh/site.h"
#include "modal/modes.h"

namespace chladni::placement {

/// What is placed: a sensor, an actuator, or a pair of both.
struct Device {
  std::optional<Eigen::Vector3d> direction;  ///< unit; none: the surface's outward normal
  double footprint = 0.0;  ///< [m] diameter of the disc that it averages over; 0: a point
};

/// n places, m modes.
struct Sites {
  Points position;        ///< n×3 [m]
  Points normal;          ///< n×3, outward, unit
  Eigen::VectorXi patch;  ///< n, index into TetMesh::patch_names
  Eigen::VectorXd area;   ///< n [m²]: the part of the surface that each stands for; ones in a grid
  Eigen::MatrixXd shapes;   ///< n×m [kg^-1/2], along the device's direction, over its footprint
  Eigen::MatrixXd slopes;   ///< n×m [kg^-1/2 m^-1]: how fast the shape changes along the surface
  std::vector<char> whole;  ///< n: 1 where the whole footprint lies on the body

  [[nodiscard]] Eigen::Index count() const { return position.rows(); }
};

/// The chosen rows.
[[nodiscard]] Sites part(const Sites& sites, const std::vector<Eigen::Index>& rows);

/// A surface as points and the triangles between them, for maps.
struct Surface {
  Sites sites;  ///< one per node and patch (at a sharp edge a node is there twice), or node
  Eigen::VectorXi node;  ///< n, of the mesh
  Cells triangles;       ///< t×3, rows of `sites`, outward
};

/// Samples modes where a device would sit. Mesh and modes must outlive it.
class Sampler {
 public:
  /// @param modes  shapes on all nodes: 3·nodes rows
  /// @throws InvalidInput  the shapes do not fit the mesh, the direction is no unit vector, the
  ///                       footprint is negative
  Sampler(const mesh::TetMesh& body, const modal::Modes& modes, Device device);

  /// Every node of the named patches; of all where `patches` is empty. Cost: a few searches in the
  /// surface per point (seven and twelve more with a footprint), on all cores.
  /// @throws InvalidInput  there is no patch of a name (lists those there are)
  [[nodiscard]] Surface surface(const std::vector<std::string>& patches) const;

  /// Every node of the marked boundary faces once, whatever patches meet there: for faces without
  /// sharp edges between them. A node on the border of two patches is of the smaller one.
  /// @param faces  1 where wanted, per boundary face
  /// @throws InvalidInput  not one mark per face
  [[nodiscard]] Surface smooth_surface(const std::vector<char>& faces) const;

  /// Places found before, each standing for the same area.
  [[nodiscard]] Sites at(const std::vector<mesh::Site>& places) const;

  [[nodiscard]] const mesh::SiteFinder& finder() const { return finder_; }
  [[nodiscard]] const mesh::TetMesh& body() const { return body_; }

 private:
  [[nodiscard]] Surface sampled(Surface surface) const;
  void see(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, Eigen::Index row,
           Sites& sites) const;
  [[nodiscard]] Eigen::RowVectorXd value(const mesh::Site& site,
                                         const Eigen::Vector3d& direction) const;

  const mesh::TetMesh& body_;
  const modal::Modes& modes_;
  Device device_;
  mesh::SiteFinder finder_;
  double step_;  // of the differences along the surface [m]
};

}  // namespace chladni::placement
