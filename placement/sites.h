// Places for a device on a body's surface, and the mode shapes that it sees there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/arrays.h"
#include "mesh/site.h"
#include "modal/modes.h"

namespace chladni::placement {

/// The device to be placed: a sensor, an actuator, or a pair of both.
struct Device {
  std::optional<Eigen::Vector3d> direction;  ///< unit; none: the outward normal of the surface
  double footprint = 0.0;  ///< [m] diameter of the disc over which it averages; 0: a point
};

/// n places, m modes.
struct Sites {
  Points position;          ///< n×3 [m]
  Points normal;            ///< n×3, outward, unit
  Eigen::VectorXi patch;    ///< n, index into TetMesh::patch_names
  Eigen::VectorXd area;     ///< n [m²]: the area of each point; 1 for single places
  Eigen::MatrixXd shapes;   ///< n×m [kg^-1/2], along the device's direction, over its footprint
  Eigen::MatrixXd slopes;   ///< n×m [kg^-1/2 m^-1]: gradient of the shape along the surface
  std::vector<char> whole;  ///< n: 1 where the whole footprint lies on the body

  [[nodiscard]] Eigen::Index count() const { return position.rows(); }
};

/// The given rows.
[[nodiscard]] Sites part(const Sites& sites, const std::vector<Eigen::Index>& rows);

/// A surface as points and the triangles between them, for maps.
struct Surface {
  Sites sites;  ///< one per node and patch (a node at a sharp edge occurs twice), or one per node
  Eigen::VectorXi node;          ///< n, of the mesh
  Cells triangles;               ///< t×3, rows of `sites`, outward
  std::vector<char> faces = {};  ///< per boundary face of the body: 1 where it is part of this
};

/// Finds places on some faces of a body, as if it had no others. The body must outlive it.
class FaceFinder {
 public:
  /// @param faces  1 where wanted, per boundary face
  /// @throws InvalidInput  not one mark per face, or no face is wanted
  FaceFinder(const mesh::TetMesh& body, const std::vector<char>& faces);
  FaceFinder(FaceFinder&&) = delete;

  /// The nearest point of these faces; `face` is the row of the whole body.
  [[nodiscard]] mesh::Site nearest(const Eigen::Vector3d& point) const;
  /// The highest point of these faces on the vertical line through (x, y), on faces that look up if
  /// there are some; none where the line misses them.
  [[nodiscard]] std::optional<mesh::Site> on_line(double x, double y) const;

 private:
  [[nodiscard]] mesh::Site in_body(mesh::Site site) const;

  std::vector<Eigen::Index> rows_;  // of the body's faces
  mesh::TetMesh part_;              // points and wanted faces
  mesh::SiteFinder finder_;
  double slack_;  // [m]
};

/// Samples modes at possible places of a device. Mesh and modes must live longer than it.
class Sampler {
 public:
  /// @param modes  shapes on all nodes: 3·nodes rows
  /// @throws InvalidInput  the shapes do not fit the mesh, the direction is no unit vector, the
  ///                       footprint is negative
  Sampler(const mesh::TetMesh& body, const modal::Modes& modes, Device device);

  /// Every node of the named patches; of all if `patches` is empty. Cost: a few searches in the
  /// surface per point (seven and twelve more with a footprint), on all cores.
  /// @throws InvalidInput  a patch name does not exist (the message lists the names)
  [[nodiscard]] Surface surface(const std::vector<std::string>& patches) const;

  /// Every node of the marked boundary faces once, even where patches meet: for faces without sharp
  /// edges between them. A node on the border of two patches belongs to the smaller one.
  /// @param faces  1 where wanted, per boundary face
  /// @throws InvalidInput  not one mark per face
  [[nodiscard]] Surface smooth_surface(const std::vector<char>& faces) const;

  /// Samples at places found before; each has the area 1.
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
  double step_;  // step of the differences along the surface [m]
};

}  // namespace chladni::placement
