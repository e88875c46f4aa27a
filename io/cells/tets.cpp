#include "io/cells/tets.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/cells/tet_shape.h"
#include "mesh/numbering.h"

namespace chladni::io {
namespace {

constexpr double kFlat = 1e-12;   // limit of six volumes over the cube of the longest edge
constexpr double kOffEdge = 0.3;  // limit of a node's offset (largest_offset) for a note
constexpr double kCurved = 1e-9;  // a cell with a smaller offset counts as straight

using Corners3 = std::array<std::int32_t, 3>;

Corners3 sorted_corners(std::int32_t a, std::int32_t b, std::int32_t c) {
  Corners3 key{a, b, c};
  std::sort(key.begin(), key.end());
  return key;
}

std::string count_of(std::size_t count, const std::string& thing) {
  return fmt::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

}  // namespace

void Rows::sort(const std::string& what) {
  require(ids_.size() < std::numeric_limits<std::int32_t>::max(),
          "more than 2147483646 " + what + "s");
  std::sort(ids_.begin(), ids_.end());
  const auto twice = std::adjacent_find(
      ids_.begin(), ids_.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  require(twice == ids_.end(), what + " " +
                                   (twice == ids_.end() ? "" : fmt::to_string(twice->first)) +
                                   " is there twice, expected once");
}

std::int32_t Rows::row(std::int64_t id) const {
  if (ids_.empty() || id < ids_.front().first || id > ids_.back().first) return -1;
  const auto offset =
      static_cast<std::uint64_t>(id) - static_cast<std::uint64_t>(ids_.front().first);
  if (offset < ids_.size() && ids_[offset].first == id) return ids_[offset].second;  // no gap
  const auto found = std::lower_bound(
      ids_.begin(), ids_.end(), id, [](const auto& entry, auto key) { return entry.first < key; });
  return found->first == id ? found->second : -1;
}

int Names::index(const std::string& name) {
  const auto [entry, is_new] = index_.try_emplace(name, static_cast<int>(names_.size()));
  if (is_new) names_.push_back(name);
  return entry->second;
}

void Tets::node(std::int64_t id, const Eigen::Vector3d& position) {
  require(position.allFinite() && position.cwiseAbs().maxCoeff() < kLargestCoordinate,
          "node " + fmt::to_string(id) + " has a coordinate that is not finite or above 1e50");
  nodes_.add(id);
  xyz_.insert(xyz_.end(), {position[0], position[1], position[2]});
}

void Tets::tet(std::int64_t id, std::span<const std::int64_t> nodes, int region) {
  if (nodes_per_tet_ == 0) nodes_per_tet_ = nodes.size();
  require(nodes.size() == nodes_per_tet_,
          "tetrahedron " + fmt::to_string(id) + " has " + fmt::to_string(nodes.size()) +
              " nodes, those before it " + fmt::to_string(nodes_per_tet_) +
              ": expected one element order in the whole file");
  tet_ids_.push_back(id);
  tet_nodes_.insert(tet_nodes_.end(), nodes.begin(), nodes.end());
  region_.push_back(region);
}

void Tets::face(std::span<const std::int64_t, 3> corners, int patch, bool outside) {
  face_corners_.insert(face_corners_.end(), corners.begin(), corners.end());
  face_patch_.push_back(patch);
  face_outside_.push_back(outside);
}

const Rows& Tets::sorted_nodes() {
  nodes_.sort("node");
  return nodes_;
}

std::span<const std::int64_t> Tets::nodes(std::size_t tet) const {
  return std::span(tet_nodes_).subspan(tet * nodes_per_tet_, nodes_per_tet_);
}

std::string Tets::with_ids(const std::string& what, const std::vector<Eigen::Index>& rows) const {
  std::string text = fmt::to_string(rows.size()) +
                     (rows.size() == 1 ? " tetrahedron is " : " tetrahedra are ") + what +
                     ": element";
  for (std::size_t i = 0; i < std::min<std::size_t>(10, rows.size()); ++i) {
    text += " " + fmt::to_string(tet_ids_[static_cast<std::size_t>(rows[i])]);
  }
  return text + (rows.size() > 10 ? " ..." : "");
}

Cells Tets::resolved_cells() const {
  Cells cells(static_cast<Eigen::Index>(tet_count()), static_cast<Eigen::Index>(nodes_per_tet_));
  for (std::size_t t = 0; t < tet_count(); ++t) {
    const auto ids = nodes(t);
    for (std::size_t k = 0; k < nodes_per_tet_; ++k) {
      const std::int32_t row = nodes_.row(ids[k]);
      if (row < 0) {
        throw InvalidInput("element " + fmt::to_string(tet_ids_[t]) + " names node " +
                           fmt::to_string(ids[k]) + ", which the file does not define");
      }
      cells(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) = row;
    }
  }
  return cells;
}

// Drops copies of cells: some programs write an element twice if it is in two groups.
void Tets::drop_copies(Cells& cells, Notes* notes) {
  using Corners4 = std::array<std::int32_t, 4>;
  std::vector<std::pair<Corners4, Eigen::Index>> keys(tet_count());
  for (Eigen::Index t = 0; t < cells.rows(); ++t) {
    Corners4 key{cells(t, 0), cells(t, 1), cells(t, 2), cells(t, 3)};
    std::sort(key.begin(), key.end());
    keys[static_cast<std::size_t>(t)] = {key, t};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> copy(tet_count(), false);
  std::size_t copies = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first != keys[i - 1].first) continue;
    copy[static_cast<std::size_t>(keys[i].second)] = true;
    ++copies;
  }
  if (copies == 0) return;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < copy.size(); ++t) {
    if (copy[t]) continue;
    cells.row(static_cast<Eigen::Index>(kept)) = cells.row(static_cast<Eigen::Index>(t)).eval();
    tet_ids_[kept] = tet_ids_[t];
    region_[kept++] = region_[t];
  }
  tet_ids_.resize(kept);
  region_.resize(kept);
  cells.conservativeResize(static_cast<Eigen::Index>(kept), Eigen::NoChange);
  add_note(notes, count_of(copies, "element") +
                      " repeated another's corners and was left out (in two groups?)");
}

void Tets::turn_right_side_out(Cells& cells, Notes* notes) const {
  const Eigen::Map<const Points> points(xyz_.data(), static_cast<Eigen::Index>(nodes_.size()), 3);
  std::vector<Eigen::Index> flat, inverted;
  for (Eigen::Index t = 0; t < cells.rows(); ++t) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.row(k) = points.row(cells(t, k + 1)) - points.row(cells(t, 0));
    }
    const double longest = edges.rowwise().norm().maxCoeff();
    const double six_volumes = edges.determinant();
    if (std::abs(six_volumes) <= kFlat * longest * longest * longest) {
      flat.push_back(t);
    } else if (six_volumes < 0.0) {
      inverted.push_back(t);
    }
  }
  require(flat.empty(), with_ids("flat (no volume)", flat));
  if (inverted.empty()) return;
  require(std::ssize(inverted) == cells.rows(),
          with_ids("inside out while the others are not", inverted));
  for (Eigen::Index t = 0; t < cells.rows(); ++t) turn_inside_out(cells.row(t));
  add_note(notes, "all " + fmt::to_string(cells.rows()) + " elements were inside out: renumbered");
}

// Two cells of positive volume that go round a common face in the same sense lie on the same side
// of it. Such a body, as of parts that were copied or mirrored into one another, counts twice
// there.
void Tets::refuse_overlaps(const Cells& cells) const {
  std::vector<mesh::Key> keys;
  std::vector<bool> rising;
  keys.reserve(4 * static_cast<std::size_t>(cells.rows()));
  rising.reserve(keys.capacity());
  for (const auto cell : cells.rowwise()) {
    for (const auto& [i, j, k] : mesh::kTetFaces) {
      const std::int32_t a = cell(i), b = cell(j), c = cell(k);
      keys.push_back(mesh::face_key(a, b, c));
      rising.push_back((a < b && b < c) || (b < c && c < a) || (c < a && a < b));
    }
  }
  const auto faces = mesh::shared_numbers(keys, static_cast<std::int32_t>(nodes_.size()));
  std::vector<Eigen::Index> overlapping;
  for (std::size_t f = 0; f < keys.size(); ++f) {
    const auto number = static_cast<std::size_t>(faces.number[f]);
    const auto first = static_cast<std::size_t>(faces.first[number]);
    if (first == f || faces.uses[number] != 2 || rising[first] != rising[f]) continue;
    overlapping.push_back(static_cast<Eigen::Index>(first / 4));
    overlapping.push_back(static_cast<Eigen::Index>(f / 4));
  }
  std::sort(overlapping.begin(), overlapping.end());
  overlapping.erase(std::unique(overlapping.begin(), overlapping.end()), overlapping.end());
  require(overlapping.empty(),
          with_ids("on the same side of a face as another one, so that they overlap", overlapping));
}

Points Tets::used_points(Cells& cells, Notes* notes) {
  mesh_row_.assign(nodes_.size(), -1);
  for (Eigen::Index i = 0; i < cells.size(); ++i) {
    mesh_row_[static_cast<std::size_t>(cells.data()[i])] = 0;
  }
  std::int32_t used = 0;
  for (std::int32_t& row : mesh_row_) row = row < 0 ? -1 : used++;
  for (Eigen::Index i = 0; i < cells.size(); ++i) {
    cells.data()[i] = mesh_row_[static_cast<std::size_t>(cells.data()[i])];
  }
  Points points(used, 3);
  for (std::size_t n = 0; n < mesh_row_.size(); ++n) {
    if (mesh_row_[n] < 0) continue;
    points.row(mesh_row_[n]) = Eigen::Map<const Eigen::RowVector3d>(&xyz_[3 * n]);
  }
  const std::size_t dropped = mesh_row_.size() - static_cast<std::size_t>(used);
  if (dropped > 0) {
    add_note(notes, count_of(dropped, "node") + " that no tetrahedron uses left out");
  }
  return points;
}

void Tets::look_at_curved_cells(const mesh::TetMesh& mesh, Notes* notes) const {
  std::vector<Eigen::Index> off_edge, folded;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    Points nodes(mesh.tets.cols(), 3);
    for (Eigen::Index k = 0; k < nodes.rows(); ++k) nodes.row(k) = mesh.points.row(mesh.tets(t, k));
    const double off = largest_offset(nodes);
    if (off > kOffEdge) off_edge.push_back(t);
    if (off > kCurved && !(smallest_jacobian(nodes) > 0.0)) folded.push_back(t);
  }
  require(folded.empty(),
          with_ids("folded over by the mid-side nodes (wrong node order?)", folded));
  if (!off_edge.empty()) {
    add_note(notes, with_ids("curved by more than 0.3 of an edge (mid-side nodes in "
                             "another order?) and kept so",
                             off_edge));
  }
}

std::int32_t Tets::mesh_row(std::int64_t node_id) const {
  const std::int32_t row = nodes_.row(node_id);
  return row < 0 ? -1 : mesh_row_[static_cast<std::size_t>(row)];
}

Eigen::VectorXi Tets::patches_by_faces(const Cells& faces, Notes* notes) const {
  std::vector<std::pair<Corners3, std::size_t>> claims;
  for (std::size_t f = 0; f < face_patch_.size(); ++f) {
    const std::int64_t* id = &face_corners_[3 * f];
    claims.emplace_back(sorted_corners(mesh_row(id[0]), mesh_row(id[1]), mesh_row(id[2])), f);
  }
  std::sort(claims.begin(), claims.end());
  std::vector<bool> met = face_outside_;
  met.flip();
  Eigen::VectorXi patch = Eigen::VectorXi::Constant(faces.rows(), -1);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Corners3 key = sorted_corners(faces(f, 0), faces(f, 1), faces(f, 2));
    auto claim = std::lower_bound(claims.begin(), claims.end(), std::pair(key, std::size_t{0}));
    for (bool first = true; claim != claims.end() && claim->first == key; ++claim, first = false) {
      if (first) patch[f] = face_patch_[claim->second];
      met[claim->second] = true;
    }
  }
  const auto inside = static_cast<std::size_t>(std::count(met.begin(), met.end(), false));
  if (inside > 0) {
    add_note(notes,
             count_of(inside, "triangle") + " of patches not on the outer boundary left out");
  }
  return patch;
}

// A face belongs to the first set that contains its three corners. A set that contains all faces
// (usually all nodes) names no patch.
void Tets::claim_by_node_sets(const Cells& faces, Eigen::Index node_count, Eigen::VectorXi& patch) {
  std::vector<bool> inside(static_cast<std::size_t>(node_count));
  for (const NodeSet& set : node_sets_) {
    if (set.nodes.size() < 3) continue;
    inside.assign(inside.size(), false);
    for (const std::int64_t id : set.nodes) {
      if (const auto row = mesh_row(id); row >= 0) inside[static_cast<std::size_t>(row)] = true;
    }
    std::vector<Eigen::Index> held;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      const auto holds = [&](int k) { return inside[static_cast<std::size_t>(faces(f, k))]; };
      if (holds(0) && holds(1) && holds(2)) held.push_back(f);
    }
    if (held.empty() || std::ssize(held) == faces.rows()) continue;
    for (const Eigen::Index f : held) {
      if (patch[f] < 0) patch[f] = patches.index(set.name);
    }
  }
}

void Tets::name_boundary(mesh::TetMesh& mesh, Notes* notes) {
  mesh::find_boundary(mesh);
  Eigen::VectorXi patch = patches_by_faces(mesh.faces, notes);
  claim_by_node_sets(mesh.faces, mesh.points.rows(), patch);
  if ((patch.array() < 0).all()) return mesh::name_patches(mesh);
  Names named;  // only patches that have a face, in the order of the file
  std::vector<bool> has_face(patches.all().size(), false);
  for (const int p : patch) {
    if (p >= 0) has_face[static_cast<std::size_t>(p)] = true;
  }
  for (std::size_t p = 0; p < has_face.size(); ++p) {
    if (has_face[p]) static_cast<void>(named.index(patches.all()[p]));
  }
  for (int& p : patch) {
    p = named.index(p < 0 ? "other" : patches.all()[static_cast<std::size_t>(p)]);
  }
  mesh.face_patch = patch;
  mesh.patch_names = named.all();
}

mesh::TetMesh Tets::mesh(Notes* notes) {
  require(tet_count() > 0, "no tetrahedron in the file, expected a body meshed in the volume");
  static_cast<void>(sorted_nodes());
  mesh::TetMesh result;
  result.tets = resolved_cells();
  drop_copies(result.tets, notes);
  turn_right_side_out(result.tets, notes);
  refuse_overlaps(result.tets);
  result.points = used_points(result.tets, notes);
  if (result.order() > 1) look_at_curved_cells(result, notes);
  Names used;
  result.region.resize(result.tets.rows());
  for (Eigen::Index t = 0; t < result.tets.rows(); ++t) {
    result.region[t] =
        used.index(regions.all()[static_cast<std::size_t>(region_[static_cast<std::size_t>(t)])]);
  }
  result.region_names = used.all();
  name_boundary(result, notes);
  return result;
}

}  // namespace chladni::io
