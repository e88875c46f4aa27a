// How the material at a place of the surface moves, as rows on the nodes around it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/site.h"

namespace chladni::fem {

/// Displacement and rotation of k nodes' worth of material: rows × the nodes' displacements
/// (x0 y0 z0 x1 ...). Any rigid motion of the nodes comes out exactly.
struct SiteMotion {
  Eigen::VectorXi nodes;                                  ///< k
  Eigen::Matrix<double, 3, Eigen::Dynamic> displacement;  ///< 3×3k [1]
  Eigen::Matrix<double, 3, Eigen::Dynamic> rotation;      ///< 3×3k [1/m], small angles [rad]
};

/// The tetrahedra that the sites' faces belong to; −1 where a site is on no face of `body`.
/// Cost: one pass over the tetrahedra, however many sites there are.
[[nodiscard]] std::vector<Eigen::Index> tets_below(const mesh::TetMesh& body,
                                                   const std::vector<mesh::Site>& sites);

/// At the point itself: the face's shape functions, and half the curl of the displacement in `tet`,
/// the tetrahedron below the face.
/// @throws InvalidInput  the site is not on a face of `body`, or not on one of `tet`
[[nodiscard]] SiteMotion point_motion(const mesh::TetMesh& body, const mesh::Site& site,
                                      Eigen::Index tet);

/// Of a rigid disc of `diameter` [m] that touches the body evenly: the rigid motion nearest, in the
/// mean square over the area, to that of the surface within the disc, taken at the site (the
/// "distributing coupling", RBE3). A force through it is spread over the area, its resultant goes
/// through the site. The surface within the disc is that of the faces that look the same way to
/// within 60 degrees and lie no deeper than a radius; what hangs over an edge is left out.
/// Cost: one pass over the boundary faces.
/// @throws InvalidInput  diameter is not positive, less than 1e-6 of the face's size, or takes in
/// more than
///                       1000 nodes (the rows are dense)
[[nodiscard]] SiteMotion footprint_motion(const mesh::TetMesh& body, const mesh::Site& site,
                                          double diameter);

}  // namespace chladni::fem
