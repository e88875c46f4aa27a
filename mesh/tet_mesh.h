// Tetrahedra that fill a body, with the faces and named patches of its boundary.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::mesh {

/// Nodes of a tetrahedron and of a triangle per polynomial order, in VTK's order (VTK_TETRA,
/// VTK_QUADRATIC_TETRA, VTK_LAGRANGE_TETRAHEDRON and their triangles): the corners, then the inner
/// nodes of each edge in the order of `kTetEdges`, from its first to its second corner, then (order
/// 3) the centre of each face in the order of `kTetFaces`. This order was read from VTK 9.1 itself.
[[nodiscard]] constexpr int tet_nodes(int order) { return order == 1 ? 4 : order == 2 ? 10 : 20; }
[[nodiscard]] constexpr int face_nodes(int order) { return order == 1 ? 3 : order == 2 ? 6 : 10; }

inline constexpr std::array<std::array<int, 2>, 6> kTetEdges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
inline constexpr std::array<std::array<int, 3>, 4> kTetFaces{
    {{0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 2, 1}}};  ///< outward
inline constexpr std::array<std::array<int, 2>, 3> kTriangleEdges{{{0, 1}, {1, 2}, {2, 0}}};

/// Barycentric coordinates of the nodes of a tetrahedron (tet_nodes x 4) and of a triangle
/// (face_nodes x 3) of `order`. All shape functions read this one table.
/// @throws InvalidInput  order is not 1, 2 or 3
[[nodiscard]] Eigen::MatrixXd tet_node_barycentric(int order);
[[nodiscard]] Eigen::MatrixXd triangle_node_barycentric(int order);

/// Row f lists the nodes of a tetrahedron on its face kTetFaces[f], as a triangle of `order`
/// (4 x face_nodes). @throws InvalidInput  as above
[[nodiscard]] Eigen::MatrixXi tet_face_nodes(int order);

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

/// The same tetrahedra (their four corners) with nodes of `order` 1, 2 or 3: on straight edges and
/// flat faces where the old ones are, and on the old curved ones where they are not. So order 3 is
/// the shape of order 2; order 2 of 3 is near it; order 1 has straight edges only. Nodes on edges
/// and faces are new; all cells of an edge or face share them. Corners keep their order and come
/// first. Regions and patches are kept. A linear shell without cells gets its faces' nodes. Linear.
/// @throws InvalidInput  order is not 1, 2 or 3, a tetrahedron names a point that is not there, or
///                       a boundary face belongs to no tetrahedron
[[nodiscard]] TetMesh with_order(const TetMesh& mesh, int order);

/// How far the cells are bent: the largest distance of a node from its place on the straight edge
/// or flat face, over the longest edge of the cell. 0 for order 1. Cost: linear.
[[nodiscard]] double largest_bend(const TetMesh& mesh);

/// Finds the boundary faces of `mesh.tets` (faces of only one tetrahedron), outward, all in patch 0
/// "boundary". For meshes from files. Cost: linear.
/// @throws InvalidInput  a tetrahedron names a point that is not there, or a face belongs to more
///                       than two tetrahedra
void find_boundary(TetMesh& mesh);

/// Finds and names the patches of a boundary without names. Faces are joined while the angle
/// between neighbours stays below `angle_degrees`. Flat patches at the highest and lowest z are
/// named "top" and "bottom"; "x_min", "x_max", "y_min", "y_max" are found in the same way. Other
/// patches are named "side_1", "side_2", ... by falling area. Flat patches of one extreme plane
/// share its name. Cost: n log n.
void name_patches(TetMesh& mesh, double angle_degrees = 40.0);

/// Renumbers nodes and cells along the longest direction of the bounding box. Neighbours in space
/// become neighbours in memory, which makes assembly and matrix products fast. Shapes and patches
/// do not change; corners no longer come first. Cost: n log n.
void sort_in_space(TetMesh& mesh);

/// The volume that the boundary encloses [m^3]: the flat tetrahedra plus the bulges of curved outer
/// faces. Curved faces inside the body do not change the sum. Cost: linear. Needs the boundary
/// (`find_boundary`) where cells are curved.
[[nodiscard]] double volume(const TetMesh& mesh);

/// The shape quality of the tetrahedra (corners only).
struct Quality {
  double smallest_dihedral_degrees = 0.0;
  double largest_dihedral_degrees = 0.0;
  double smallest_radius_ratio = 0.0;  ///< 3 r_in / r_circumscribed: 1 regular, 0 flat
  double mean_radius_ratio = 0.0;
  double smallest_volume = 0.0;  ///< [m^3]
  double shortest_edge = 0.0;    ///< [m]
  double longest_edge = 0.0;     ///< [m]
  Eigen::Index worst_tet = -1;   ///< the tetrahedron with the smallest radius ratio
};
[[nodiscard]] Quality quality(const TetMesh& mesh);

/// Checks whether the mesh can be used for elements.
///
/// @throws InvalidInput  names the first ten offenders with their places: a tetrahedron is inverted
///     or flat (a curved one: at any of its nodes), an index is out of range, a coordinate is not
///     finite, a point is used by no tetrahedron, the arrays do not fit together, the cells form
///     several bodies that share no node, or the cells form parts that meet in edges and nodes only
///     and so can move against each other at no cost
/// Cost: linear.
void check(const TetMesh& mesh);

}  // namespace chladni::mesh
