// Tetrahedra that fill a body, with the faces and named patches of its boundary.
#pragma once

#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::mesh {

/// Nodes of a tetrahedron and of a triangle per polynomial order, in VTK's order (Lagrange cells
/// for order 3, where an edge carries its two nodes from its first to its second corner).
[[nodiscard]] constexpr int tet_nodes(int order) { return order == 1 ? 4 : order == 2 ? 10 : 20; }
[[nodiscard]] constexpr int face_nodes(int order) { return order == 1 ? 3 : order == 2 ? 6 : 10; }

struct TetMesh {
  Points points;                          ///< N×3 [m], every one used by a tetrahedron
  Cells tets;                             ///< T×4, T×10 or T×20, positive volume
  Eigen::VectorXi region;                 ///< T, index into region_names
  Cells faces;                            ///< F×3, F×6 or F×10: the outer boundary, outward
  Eigen::VectorXi face_patch;             ///< F, index into patch_names
  std::vector<std::string> patch_names;   ///< as in the Surface
  std::vector<std::string> region_names;  ///< at least one: "body"

  [[nodiscard]] int order() const { return tets.cols() == 4 ? 1 : tets.cols() == 10 ? 2 : 3; }
  [[nodiscard]] Eigen::Index node_count() const { return points.rows(); }
  [[nodiscard]] Eigen::Index tet_count() const { return tets.rows(); }
};

/// The same tetrahedra (their four corners) with nodes of `order` 1, 2 or 3 on straight edges and
/// flat faces; mid-edge nodes are ours, shared by all cells of the edge. Corners keep their order
/// and come first. Regions and patches are kept. Cost: linear.
[[nodiscard]] TetMesh with_order(const TetMesh& mesh, int order);

/// Boundary faces of `mesh.tets` (faces that only one tetrahedron has), outward, patch 0
/// "boundary". For meshes from files.
void find_boundary(TetMesh& mesh);

/// The patches of a boundary without names: faces joined while the angle between neighbours stays
/// below `angle_degrees`; named "top" and "bottom" for flat ones at the highest and lowest z,
/// "x_min", "x_max", "y_min", "y_max" likewise, else "side_1", "side_2", ... by falling area.
void name_patches(TetMesh& mesh, double angle_degrees = 40.0);

/// Renumbers nodes and cells along the body's longest direction: neighbours in space become
/// neighbours in memory, which assembly and matrix products want. Shapes and patches unchanged.
void sort_in_space(TetMesh& mesh);

/// Sum of the volumes of the tetrahedra's straight-sided corners [m^3].
[[nodiscard]] double volume(const TetMesh& mesh);

/// How well the tetrahedra are shaped (corners only).
struct Quality {
  double smallest_dihedral_degrees = 0.0;
  double largest_dihedral_degrees = 0.0;
  double smallest_radius_ratio = 0.0;  ///< 3 r_in / r_circumscribed: 1 regular, 0 flat
  double mean_radius_ratio = 0.0;
  double smallest_volume = 0.0;  ///< [m^3]
  double shortest_edge = 0.0;    ///< [m]
  double longest_edge = 0.0;     ///< [m]
  Eigen::Index worst_tet = -1;   ///< of the smallest radius ratio
};
[[nodiscard]] Quality quality(const TetMesh& mesh);

/// @throws InvalidInput  a tetrahedron is inverted or flat, an index is out of range, a coordinate
///                       is not finite, the cells fall into several bodies that share no node
///                       (names each with its volume and centre), for the first ten offenders
void check(const TetMesh& mesh);

}  // namespace chladni::mesh
