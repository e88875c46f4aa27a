// Collects tetrahedra as a file lists them, with the file's own numbers, and makes a TetMesh.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/read.h"

namespace chladni::io {

/// Maps the arbitrary numbers (ids) of a file to rows.
class Rows {
 public:
  void add(std::int64_t id) { ids_.emplace_back(id, static_cast<std::int32_t>(ids_.size())); }
  /// Call this once, after the last `add`. @param what  "node"
  /// @throws InvalidInput  an id occurs twice (names it), or there are 2^31 ids
  void sort(const std::string& what);
  /// The row of `id`, −1 where there is none. Cost: logarithmic.
  [[nodiscard]] std::int32_t row(std::int64_t id) const;
  /// Ids and rows by rising id, after `sort`.
  [[nodiscard]] std::span<const std::pair<std::int64_t, std::int32_t>> sorted() const {
    return ids_;
  }
  [[nodiscard]] std::size_t size() const { return ids_.size(); }

 private:
  std::vector<std::pair<std::int64_t, std::int32_t>> ids_;
};

/// Names in the order of their first use, each with an index.
class Names {
 public:
  int index(const std::string& name);
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, int> index_;
};

/// A named set of nodes. Boundary faces inside the set become its patch.
struct NodeSet {
  std::string name;
  std::vector<std::int64_t> nodes;  ///< the file's ids; ids of no node are ignored
};

/// A reader fills this object; `mesh()` makes the mesh.
class Tets {
 public:
  /// @throws InvalidInput  a coordinate is not finite (names the node)
  void node(std::int64_t id, const Eigen::Vector3d& position);
  /// 4, 10 or 20 node ids in VTK's order; all cells must have the same number.
  void tet(std::int64_t id, std::span<const std::int64_t> nodes, int region);
  /// Adds a triangle of a patch by its three corners. Where two patches claim it, it stays with the
  /// first one.
  /// @param outside  the triangle should lie on the boundary; there is a note where it does not
  void face(std::span<const std::int64_t, 3> corners, int patch, bool outside = true);
  void node_set(NodeSet set) { node_sets_.push_back(std::move(set)); }

  Names regions;  ///< a tetrahedron's `region` indexes them
  Names patches;  ///< a face's `patch` indexes them

  [[nodiscard]] std::size_t tet_count() const { return region_.size(); }
  [[nodiscard]] std::int64_t tet_id(std::size_t tet) const { return tet_ids_[tet]; }
  void set_region(std::size_t tet, int region) { region_[tet] = region; }
  /// The nodes by their ids. @throws InvalidInput  a node occurs twice
  [[nodiscard]] const Rows& sorted_nodes();
  /// The node ids of a tetrahedron.
  [[nodiscard]] std::span<const std::int64_t> nodes(std::size_t tet) const;

  /// Makes the mesh. It resolves ids, drops copies of a cell, turns the cells where all are inside
  /// out, drops unused nodes, finds the boundary and names its patches. A patch without a name in
  /// the file is "other"; where the file names no patch, `name_patches` names them. The ids are
  /// sorted afterwards; call this once.
  /// @throws InvalidInput  no tetrahedron, an id that is missing or occurs twice, cells that are
  ///                       flat or inside out (by the file's ids, the first ten) or that lie on the
  ///                       same side of a common face, a curved cell that folds over
  [[nodiscard]] mesh::TetMesh mesh(Notes* notes);

 private:
  [[nodiscard]] Cells resolved_cells() const;
  void drop_copies(Cells& cells, Notes* notes);
  void turn_right_side_out(Cells& cells, Notes* notes) const;
  void refuse_overlaps(const Cells& cells) const;
  [[nodiscard]] Points used_points(Cells& cells, Notes* notes);
  void look_at_curved_cells(const mesh::TetMesh& mesh, Notes* notes) const;
  [[nodiscard]] std::string with_ids(const std::string& what,
                                     const std::vector<Eigen::Index>& rows) const;
  [[nodiscard]] std::int32_t mesh_row(std::int64_t node_id) const;
  [[nodiscard]] Eigen::VectorXi patches_by_faces(const Cells& faces, Notes* notes) const;
  void claim_by_node_sets(const Cells& faces, Eigen::Index node_count, Eigen::VectorXi& patch);
  void name_boundary(mesh::TetMesh& mesh, Notes* notes);

  Rows nodes_;
  std::vector<std::int32_t> mesh_row_;  // for each row of nodes_; −1: no cell uses the node
  std::vector<double> xyz_;
  std::vector<std::int64_t> tet_ids_, tet_nodes_;
  std::vector<int> region_;
  std::size_t nodes_per_tet_ = 0;
  std::vector<std::int64_t> face_corners_;
  std::vector<int> face_patch_;
  std::vector<bool> face_outside_;
  std::vector<NodeSet> node_sets_;
};

}  // namespace chladni::io
