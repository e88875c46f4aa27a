// Motion of the material at a place of the surface, as rows on the nodes around this place.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/site.h"

namespace chladni::fem {

/// Displacement and rotation at a place, as rows that multiply the displacements of k nodes
/// (x0 y0 z0 x1 ...). The rows reproduce any rigid motion of the nodes exactly.
struct SiteMotion {
  Eigen::VectorXi nodes;                                  ///< k
  Eigen::Matrix<double, 3, Eigen::Dynamic> displacement;  ///< 3×3k [1]
  Eigen::Matrix<double, 3, Eigen::Dynamic> rotation;      ///< 3×3k [1/m], small angles [rad]
};

/// The tetrahedra that the sites' faces belong to; −1 where a site is on no face of `body`.
/// Cost: one pass over the tetrahedra, for any number of sites.
[[nodiscard]] std::vector<Eigen::Index> tets_below(const mesh::TetMesh& body,
                                                   const std::vector<mesh::Site>& sites);

/// The motion at the point itself. The displacement follows the face's shape functions. The
/// rotation is half the curl of the displacement in `tet`, the tetrahedron below the face.
/// @throws InvalidInput  the site is not on a face of `body`, or not on one of `tet`
[[nodiscard]] SiteMotion point_motion(const mesh::TetMesh& body, const mesh::Site& site,
                                      Eigen::Index tet);

/// The motion of a rigid disc of `diameter` [m] that touches the body evenly. It is the rigid
/// motion, taken at the site, that fits the motion of the surface within the disc best in the mean
/// square over the area (the "distributing coupling", RBE3). A force on the disc is spread over the
/// area and its resultant goes through the site. The surface within the disc consists of faces
/// whose normals differ by less than 60 degrees from the site's and which lie no deeper than one
/// radius. Parts of the disc beyond an edge are left out. Cost: one pass over the boundary faces.
/// @throws InvalidInput  diameter is not positive, is less than 1e-6 of the face's size, or the
///                       disc takes in more than 1000 nodes (the rows are dense)
[[nodiscard]] SiteMotion footprint_motion(const mesh::TetMesh& body, const mesh::Site& site,
                                          double diameter);

}  // namespace chladni::fem
