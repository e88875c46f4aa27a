// Reads Gmsh's MSH 2.2 and 4.1, text or binary (Gmsh's reference manual, "MSH file format").
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>

#include "base/error.h"
#include "io/cells/msh_cell.h"
#include "io/cells/tets.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Entity = std::pair<int, std::int64_t>;  // dimension and tag

class MshReader {
 public:
  explicit MshReader(std::string_view bytes) : scanner_(bytes), values_(scanner_, Encoding::text) {}
  mesh::TetMesh mesh(Notes* notes);

 private:
  void read_format();
  void read_section(std::string_view name);
  void read_physical_names();
  void read_nodes_2();
  void read_elements_2();
  void read_entities_4();
  void read_nodes_4();
  void read_elements_4();
  void skip_to_end_of(std::string_view name);
  void read_element(std::int64_t id, const MshCell& cell, std::int64_t physical);
  const MshCell& known_cell(std::int64_t code);
  std::string name_of(const Entity& physical) const;
  std::int64_t size(std::string_view what);

  Scanner scanner_;
  Values values_;
  bool is_4_ = false;
  std::map<Entity, std::string> physical_names_;
  std::map<Entity, std::int64_t> physical_of_entity_;
  std::map<std::string, std::size_t> passed_over_;  // cells that are neither tetrahedra nor faces
  std::size_t triangles_ = 0, entities_in_two_groups_ = 0, partitioned_ = 0;
  Tets tets_;
};

std::int64_t MshReader::size(std::string_view what) {  // a size_t of version 4
  const auto value = values_.next<std::uint64_t>(what);
  if (!std::in_range<std::int64_t>(value)) scanner_.fail(std::string(what) + " is out of range");
  return static_cast<std::int64_t>(value);
}

void MshReader::read_format() {
  if (scanner_.word() != "$MeshFormat") {
    throw InvalidInput(
        "the file does not start with '$MeshFormat', expected Gmsh's MSH 2.2 or 4.1");
  }
  const std::string version(scanner_.word());
  is_4_ = version == "4.1";
  if (!is_4_ && !version.starts_with("2")) {
    scanner_.fail("MSH version " + shown(version) +
                  ", expected 4.1 or 2.2 (in Gmsh: File, Export, or -format msh41)");
  }
  const std::int64_t binary = scanner_.integer("the file type");
  const std::int64_t size = scanner_.integer("the data size");
  if (binary < 0 || binary > 1)
    scanner_.fail("file type " + fmt::to_string(binary) + ", expected 0 or 1");
  if (binary == 1) {
    if (size != 8) scanner_.fail("data size " + fmt::to_string(size) + ", expected 8");
    static_cast<void>(scanner_.next_line());
    values_ = Values(scanner_, Encoding::little_endian);
    const auto one = values_.next<std::int32_t>("the number 1 that tells the byte order");
    if (one == 0x01000000) {
      values_ = Values(scanner_, Encoding::big_endian);
    } else if (one != 1) {
      scanner_.fail("found " + fmt::to_string(one) + " where the number 1 tells the byte order");
    }
  }
  scanner_.expect("$EndMeshFormat");
}

void MshReader::read_physical_names() {
  const std::int64_t count = scanner_.count("physical names", 6);
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t dimension = scanner_.integer("the dimension of a physical name");
    const std::int64_t tag = scanner_.integer("the tag of a physical name");
    std::string_view name = scanner_.rest_of_line();
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') {
      name = name.substr(1, name.size() - 2);
    }
    if (dimension < 0 || dimension > 3)
      scanner_.fail("a physical name of dimension " + fmt::to_string(dimension));
    physical_names_[{static_cast<int>(dimension), tag}] = std::string(name);
  }
}

std::string MshReader::name_of(const Entity& physical) const {
  const auto& [dimension, tag] = physical;
  const auto named = physical_names_.find(physical);
  if (named != physical_names_.end() && !named->second.empty()) return named->second;
  if (tag == 0) return dimension == 3 ? "body" : "other";
  return (dimension == 3 ? "volume_" : "surface_") + fmt::to_string(tag);
}

const MshCell& MshReader::known_cell(std::int64_t code) {
  const MshCell* const cell = msh_cell(code);
  if (cell == nullptr) scanner_.fail("unknown element type " + fmt::to_string(code));
  if (cell->dimension == 3 && cell->kind != MshCell::Kind::tetrahedron) {
    scanner_.fail("a " + std::string(cell->name) + " (element type " + fmt::to_string(code) +
                  "), expected tetrahedra of 4, 10 or 20 nodes: mesh the volume without "
                  "recombination, order 1 to 3");
  }
  return *cell;
}

void MshReader::read_element(std::int64_t id, const MshCell& cell, std::int64_t physical) {
  std::array<std::int64_t, kMostMshNodes> file_order{};
  for (int k = 0; k < cell.nodes; ++k) {
    file_order.at(static_cast<std::size_t>(k)) =
        is_4_ ? size("a node of an element") : values_.next<std::int32_t>("a node of an element");
  }
  if (cell.kind == MshCell::Kind::tetrahedron) {
    std::array<std::int64_t, 20> vtk_order{};
    const auto count = static_cast<std::size_t>(cell.nodes);
    for (std::size_t k = 0; k < count; ++k)
      vtk_order.at(k) = file_order.at(msh_tet_order(count)[k]);
    tets_.tet(id, std::span(vtk_order).first(count), tets_.regions.index(name_of({3, physical})));
  } else if (cell.kind == MshCell::Kind::triangle) {
    ++triangles_;
    if (physical != 0) {
      tets_.face(std::span(file_order).first<3>(), tets_.patches.index(name_of({2, physical})));
    }
  } else if (cell.dimension == 2) {
    ++passed_over_[std::string(cell.name)];
  }
}

void MshReader::read_nodes_2() {
  const std::int64_t count = scanner_.count("nodes", values_.is_text() ? 8 : 28);
  if (!values_.is_text()) static_cast<void>(scanner_.next_line());
  for (std::int64_t n = 0; n < count; ++n) {
    const auto id = values_.next<std::int32_t>("a node's number");
    Eigen::Vector3d p;
    for (double& x : p) x = values_.next<double>("a node's coordinate");
    tets_.node(id, p);
  }
}

// Reads the elements of version 2. In text, each element counts as a block of one element, and its
// number stands before its type.
void MshReader::read_elements_2() {
  const bool text = values_.is_text();
  std::int64_t left = scanner_.count("elements", text ? 8 : 8);
  if (!text) static_cast<void>(scanner_.next_line());
  while (left > 0) {
    const std::int64_t text_id = text ? scanner_.integer("an element's number") : 0;
    const MshCell& cell = known_cell(values_.next<std::int32_t>("an element's type"));
    const std::int64_t block = text ? 1 : values_.next<std::int32_t>("elements of a block");
    const auto tags = values_.next<std::int32_t>("the number of an element's tags");
    if (block < 1 || block > left)
      scanner_.fail("a block of " + fmt::to_string(block) + " elements, " + fmt::to_string(left) +
                    " are left");
    scanner_.require_room(tags, "tags", text ? 2 : 4);
    for (std::int64_t e = 0; e < block; ++e) {
      const std::int64_t id = text ? text_id : values_.next<std::int32_t>("an element's number");
      std::int64_t physical = 0;
      for (std::int32_t t = 0; t < tags; ++t) {
        const std::int64_t tag = values_.next<std::int32_t>("an element's tag");
        if (t == 0) physical = std::abs(tag);
        if (t == 2 && tag > 1) ++partitioned_;
      }
      read_element(id, cell, physical);
    }
    left -= block;
  }
}

void MshReader::read_entities_4() {
  std::array<std::int64_t, 4> counts{};
  for (std::int64_t& count : counts) {
    count = size("the number of entities");
    scanner_.require_room(count, "entities", values_.is_text() ? 10 : 36);
  }
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::int64_t e = 0; e < counts.at(static_cast<std::size_t>(dimension)); ++e) {
      const std::int64_t tag = values_.next<std::int32_t>("an entity's tag");
      for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) {
        static_cast<void>(values_.next<double>("an entity's box"));
      }
      const std::int64_t groups = size("an entity's physical groups");
      for (std::int64_t g = 0; g < groups; ++g) {
        const std::int64_t group = values_.next<std::int32_t>("a physical group");
        if (g == 0) physical_of_entity_[{dimension, tag}] = std::abs(group);
      }
      if (groups > 1 && dimension > 1) ++entities_in_two_groups_;
      const std::int64_t bounding = dimension == 0 ? 0 : size("an entity's boundaries");
      for (std::int64_t b = 0; b < bounding; ++b) {
        static_cast<void>(values_.next<std::int32_t>("an entity's boundary"));
      }
    }
  }
}

void MshReader::read_nodes_4() {
  const std::int64_t blocks = size("the number of node blocks");
  const std::int64_t nodes = size("the number of nodes");
  scanner_.require_room(nodes, "nodes", values_.is_text() ? 8 : 32);
  static_cast<void>(size("the smallest node number"));
  static_cast<void>(size("the largest node number"));
  std::int64_t found = 0;
  std::vector<std::int64_t> ids;
  for (std::int64_t b = 0; b < blocks; ++b) {
    const auto dimension = values_.next<std::int32_t>("the dimension of a node block");
    static_cast<void>(values_.next<std::int32_t>("the entity of a node block"));
    const auto parametric = values_.next<std::int32_t>("whether nodes are parametric");
    const std::int64_t count = size("the number of nodes of a block");
    scanner_.require_room(count, "nodes", values_.is_text() ? 8 : 32);
    ids.resize(static_cast<std::size_t>(count));
    for (std::int64_t& id : ids) id = size("a node's number");
    const int extra = parametric == 0 ? 0 : std::clamp<int>(dimension, 0, 3);
    for (const std::int64_t id : ids) {
      Eigen::Vector3d p;
      for (double& x : p) x = values_.next<double>("a node's coordinate");
      for (int i = 0; i < extra; ++i) static_cast<void>(values_.next<double>("a parameter"));
      tets_.node(id, p);
    }
    found += count;
  }
  if (found != nodes)
    scanner_.fail("the header claims " + fmt::to_string(nodes) + " nodes, the blocks have " +
                  fmt::to_string(found));
}

void MshReader::read_elements_4() {
  const std::int64_t blocks = size("the number of element blocks");
  const std::int64_t elements = size("the number of elements");
  scanner_.require_room(elements, "elements", values_.is_text() ? 4 : 16);
  static_cast<void>(size("the smallest element number"));
  static_cast<void>(size("the largest element number"));
  std::int64_t found = 0;
  for (std::int64_t b = 0; b < blocks; ++b) {
    const int dimension = values_.next<std::int32_t>("the dimension of an element block");
    const std::int64_t entity = values_.next<std::int32_t>("the entity of an element block");
    const MshCell& cell = known_cell(values_.next<std::int32_t>("an element type"));
    const std::int64_t count = size("the number of elements of a block");
    scanner_.require_room(count, "elements", values_.is_text() ? 4 : 16);
    const auto group = physical_of_entity_.find({dimension, entity});
    const std::int64_t physical = group == physical_of_entity_.end() ? 0 : group->second;
    for (std::int64_t e = 0; e < count; ++e) {
      const std::int64_t id = size("an element's number");
      read_element(id, cell, physical);
    }
    found += count;
  }
  if (found != elements)
    scanner_.fail("the header claims " + fmt::to_string(elements) + " elements, the blocks have " +
                  fmt::to_string(found));
}

void MshReader::skip_to_end_of(std::string_view name) {
  const std::size_t end = scanner_.remaining().find("$End" + std::string(name));
  if (end == std::string_view::npos) scanner_.fail_truncated("'$End" + std::string(name) + "'");
  static_cast<void>(scanner_.raw(end, "a section"));
}

void MshReader::read_section(std::string_view name) {
  if (name == "PartitionedEntities" || name == "GhostElements") {
    scanner_.fail("a partitioned mesh ($" + std::string(name) +
                  "), expected one piece: in Gmsh, Mesh, Unpartition, and save again");
  }
  if (!values_.is_text() && name != "PhysicalNames" && is_4_)
    static_cast<void>(scanner_.next_line());
  if (name == "PhysicalNames") return read_physical_names();
  if (name == "Entities" && is_4_) return read_entities_4();
  if (name == "Nodes") return is_4_ ? read_nodes_4() : read_nodes_2();
  if (name == "Elements") return is_4_ ? read_elements_4() : read_elements_2();
  skip_to_end_of(name);
}

mesh::TetMesh MshReader::mesh(Notes* notes) {
  read_format();
  for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
    if (word[0] != '$' || word.size() < 2)
      scanner_.fail("found " + shown(word) + ", expected a section such as '$Nodes'");
    const std::string name(word.substr(1));
    read_section(name);
    scanner_.expect("$End" + name);
  }
  if (tets_.tet_count() == 0 && triangles_ > 0) {
    throw InvalidInput(fmt::to_string(triangles_) +
                       " triangles and no tetrahedron: mesh the volume "
                       "(Gmsh: -3), or save the surface as STL");
  }
  for (const auto& [name, count] : passed_over_) {
    add_note(notes, fmt::to_string(count) + " cells passed over: " + name);
  }
  if (entities_in_two_groups_ > 0) {
    add_note(notes, fmt::to_string(entities_in_two_groups_) +
                        " entities are in several physical groups: the first counts");
  }
  if (partitioned_ > 0) {
    add_note(notes,
             "partition numbers of " + fmt::to_string(partitioned_) + " elements passed over");
  }
  return tets_.mesh(notes);
}

}  // namespace

mesh::TetMesh parse_msh(std::string_view bytes, Notes* notes) {
  require(!trimmed(bytes.substr(0, 4096)).empty(), "the file is empty");
  return MshReader(bytes).mesh(notes);
}

}  // namespace chladni::io
