// Reads Abaqus and CalculiX input decks: tetrahedra, their sections (regions), surfaces and sets
// (patches). Node orders and faces are those of the CalculiX manual, "Element types".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "base/error.h"
#include "io/cells/inp_deck.h"
#include "io/cells/inp_sets.h"
#include "io/cells/tets.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

// The corners of the faces S1 to S4 of a tetrahedron.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};

// Keywords that create or move nodes and elements. They are refused, because this reader would miss
// their effect.
const std::set<std::string> kGenerators{"INCLUDE", "SYSTEM", "NGEN",  "NFILL",
                                        "NCOPY",   "NMAP",   "ELGEN", "ELCOPY"};
// Keywords whose data lines are read here; those of another file would be missed.
const std::set<std::string> kFilled{"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"};
const std::set<std::string> kSilent{"HEADING",      "PREPRINT",     "PART",
                                    "END PART",     "ASSEMBLY",     "INSTANCE",
                                    "END INSTANCE", "END ASSEMBLY", "SOLID SECTION"};

struct ElementType {
  enum class Kind { tetrahedron, triangle, line } kind;
  std::size_t nodes;
};

struct SurfaceEntry {
  std::string patch, set;
  std::int64_t element = 0;  // where `set` is empty
  int face = -1;             // 0 to 3; −1: all faces on the boundary
};

bool ends_in_letters(std::string_view type, std::size_t start) {
  return std::all_of(type.begin() + static_cast<std::ptrdiff_t>(start), type.end(),
                     [](char c) { return c >= 'A' && c <= 'Z'; });
}

// C3D10M, C3D4H and so on are tetrahedra of the same shape. Gmsh writes plane triangles and bars
// for the surfaces and lines of a body.
ElementType element_type(const InpDeck& deck, const std::string& type) {
  using enum ElementType::Kind;
  if (type.starts_with("C3D10") && ends_in_letters(type, 5)) return {tetrahedron, 10};
  if (type.starts_with("C3D4") && ends_in_letters(type, 4)) return {tetrahedron, 4};
  for (const std::string_view plane : {"CPS", "CPE", "SFM3D"}) {
    if (type == std::string(plane) + "3") return {triangle, 3};
    if (type == std::string(plane) + "6") return {triangle, 6};
  }
  if (type == "T3D2") return {line, 2};
  if (type == "T3D3") return {line, 3};
  deck.fail("element type " + shown(type) +
            ", expected tetrahedra (C3D4, C3D10); masses, springs and the like belong in the "
            "study, as attachments");
}

class InpReader {
 public:
  explicit InpReader(std::string_view bytes) : deck_(bytes) {}
  mesh::TetMesh mesh(Notes* notes);

 private:
  using Fields = std::vector<std::string_view>;
  struct Triangle {
    std::int64_t id;
    std::array<std::int64_t, 3> corners;
  };

  void read(const Keyword& keyword);
  void read_nodes(const Keyword& keyword);
  void read_elements(const Keyword& keyword);
  void read_element(const Fields& first_line, const ElementType& type, int region);
  void read_set(const Keyword& keyword, InpSets& sets, const std::string& name);
  void read_surface(const Keyword& keyword);
  void check_structure(const Keyword& keyword);
  void follow_assembly(const Keyword& keyword);
  // Nodes, elements and sets of the assembly itself are those of reference points.
  [[nodiscard]] bool of_assembly() const { return in_assembly_ && !in_instance_; }
  [[nodiscard]] std::vector<std::int64_t> elements_of(const std::string& what,
                                                      const std::string& set) const;
  [[nodiscard]] std::vector<std::int64_t> listed_by(const std::string& set, const Rows& rows) const;
  void check_members(Notes* notes) const;
  void name_regions(Notes* notes);
  bool explicit_sets_share_out(std::vector<int>& region, bool by_name);
  void name_faces(Notes* notes);
  void add_faces(const SurfaceEntry& entry, std::int64_t element);
  void name_triangles();

  InpDeck deck_;
  Tets tets_;
  InpSets node_sets_, element_sets_, card_sets_;  // card_sets_: from *ELEMENT, ELSET=
  Rows tet_rows_, triangle_rows_;
  std::vector<Triangle> triangles_;
  std::vector<std::string> sections_;
  std::vector<SurfaceEntry> surface_;
  std::set<std::string> unused_;
  std::vector<std::int64_t> ids_of_element_;
  std::size_t lines_ = 0, parts_ = 0, instances_ = 0;
  bool in_assembly_ = false, in_instance_ = false;
};

void InpReader::read_nodes(const Keyword& keyword) {
  const std::string set = keyword.value("NSET");
  for (Fields fields; deck_.next_data(fields);) {
    if (of_assembly()) continue;
    if (fields.size() != 4) {
      deck_.fail("a node of " + fmt::to_string(fields.size()) +
                 " fields, expected four: number, x, y, z (decimal commas are not read)");
    }
    const std::int64_t id = deck_.id(fields[0]);
    tets_.node(id, {deck_.number(fields[1]), deck_.number(fields[2]), deck_.number(fields[3])});
    if (!set.empty()) node_sets_.add(set, id);
  }
}

void InpReader::read_element(const Fields& first_line, const ElementType& type, int region) {
  if (first_line.empty()) deck_.fail("an element without numbers, expected its own and its nodes'");
  auto& ids = ids_of_element_;
  ids.clear();
  for (Fields fields = first_line;;) {
    for (const auto field : fields) ids.push_back(deck_.id(field));
    if (ids.size() > type.nodes || !deck_.next_data(fields)) break;
  }
  if (ids.size() != type.nodes + 1) {
    deck_.fail("element " + fmt::to_string(ids[0]) + " has " + fmt::to_string(ids.size() - 1) +
               " nodes, expected " + fmt::to_string(type.nodes));
  }
  const std::span<const std::int64_t> nodes = std::span(ids).subspan(1);
  if (type.kind == ElementType::Kind::tetrahedron) {
    tet_rows_.add(ids[0]);
    tets_.tet(ids[0], nodes, region);
  } else if (type.kind == ElementType::Kind::triangle) {
    triangle_rows_.add(ids[0]);
    triangles_.push_back({ids[0], {nodes[0], nodes[1], nodes[2]}});
  } else {
    ++lines_;
  }
}

void InpReader::read_elements(const Keyword& keyword) {
  if (of_assembly()) return;
  const ElementType type = element_type(deck_, upper(keyword.value("TYPE")));
  const std::string set = keyword.value("ELSET");
  const int region = tets_.regions.index(set.empty() ? "body" : set);
  for (Fields fields; deck_.next_data(fields);) {
    read_element(fields, type, region);
    if (!set.empty()) card_sets_.add(set, ids_of_element_[0]);
  }
}

void InpReader::read_set(const Keyword& keyword, InpSets& sets, const std::string& name) {
  if (name.empty()) deck_.fail("*" + keyword.name + " without a name");
  const bool other_numbers = of_assembly() && !keyword.has("INSTANCE");
  if (!other_numbers) sets.declare(name);
  for (Fields fields; deck_.next_data(fields);) {
    if (other_numbers) continue;
    if (keyword.has("GENERATE")) {
      if (fields.size() < 2 || fields.size() > 3) deck_.fail("expected first, last and step");
      const std::int64_t step = fields.size() == 3 ? deck_.id(fields[2]) : 1;
      sets.add_range(name, deck_.id(fields[0]), deck_.id(fields[1]), step);
      continue;
    }
    if (keyword.name == "SURFACE" && !fields.empty()) fields.resize(1);  // then an area
    for (const std::string_view field : fields) {
      if (integer_in(field)) {
        sets.add(name, deck_.id(field));
      } else if (!field.empty()) {
        sets.add_set(name, label_in(field));
      }
    }
  }
}

void InpReader::read_surface(const Keyword& keyword) {
  const std::string name = keyword.value("NAME");
  if (name.empty()) deck_.fail("*SURFACE without a name");
  if (upper(keyword.value("TYPE")) == "NODE") return read_set(keyword, node_sets_, name);
  for (Fields fields; deck_.next_data(fields);) {
    if (fields.empty() || fields.size() > 2) deck_.fail("expected an element or set, and a face");
    SurfaceEntry entry{.patch = name, .set = {}};
    if (integer_in(fields[0])) {
      entry.element = deck_.id(fields[0]);
    } else {
      entry.set = label_in(fields[0]);
    }
    if (fields.size() == 2) {
      const std::string face = upper(fields[1]);
      if (face.size() != 2 || face[0] != 'S' || face[1] < '1' || face[1] > '4') {
        deck_.fail("face " + shown(fields[1]) + ", expected S1 to S4 of a tetrahedron");
      }
      entry.face = face[1] - '1';
    }
    surface_.push_back(std::move(entry));
  }
}

void InpReader::check_structure(const Keyword& keyword) {
  const bool elsewhere = kFilled.contains(keyword.name) && keyword.has("INPUT");
  if (kGenerators.contains(keyword.name) || elsewhere) {
    deck_.fail("*" + keyword.name + " brings in or makes nodes and elements that are not in " +
               "this file, expected a flat deck: write all of them out");
  }
  if (keyword.name == "NODE" && keyword.has("SYSTEM") && upper(keyword.value("SYSTEM")) != "R") {
    deck_.fail("*NODE in a cylindrical or spherical system, expected x, y, z");
  }
  follow_assembly(keyword);
}

// An instance with its own nodes and elements (an independent one) is the body, as a part is.
void InpReader::follow_assembly(const Keyword& keyword) {
  if (keyword.name == "ASSEMBLY") in_assembly_ = true;
  if (keyword.name == "END ASSEMBLY") in_assembly_ = false;
  if (keyword.name == "END INSTANCE") in_instance_ = false;
  parts_ += keyword.name == "PART" ? 1 : 0;
  instances_ += keyword.name == "INSTANCE" ? 1 : 0;
  if (parts_ > 1 || instances_ > 1) {
    deck_.fail("several parts or instances, expected one body: write a flat deck, or merge them");
  }
  if (keyword.name != "INSTANCE") return;
  in_instance_ = true;
  for (InpSets* const sets : {&node_sets_, &element_sets_, &card_sets_}) {
    sets->set_instance(keyword.value("NAME"));
  }
  Fields fields;
  if (deck_.next_data(fields)) deck_.fail("an *INSTANCE that is moved, expected one in place");
}

void InpReader::read(const Keyword& keyword) {
  check_structure(keyword);
  if (keyword.name == "NODE") return read_nodes(keyword);
  if (keyword.name == "ELEMENT") return read_elements(keyword);
  if (keyword.name == "NSET") return read_set(keyword, node_sets_, keyword.value("NSET"));
  if (keyword.name == "ELSET") return read_set(keyword, element_sets_, keyword.value("ELSET"));
  if (keyword.name == "SURFACE") return read_surface(keyword);
  if (keyword.name == "SOLID SECTION" && keyword.has("ELSET")) {
    sections_.push_back(keyword.value("ELSET"));
  }
  constexpr std::size_t kMostNamed = 12;
  if (!kSilent.contains(keyword.name) && unused_.size() < kMostNamed) unused_.insert(keyword.name);
}

// The elements of a set, whether *ELSET or *ELEMENT names it, or both.
std::vector<std::int64_t> InpReader::elements_of(const std::string& what,
                                                 const std::string& set) const {
  if (!element_sets_.has(set) && !card_sets_.has(set)) {
    throw InvalidInput(what + " of the unknown set " + shown(set));
  }
  return element_sets_.ids(set, tet_rows_, &card_sets_);
}

// The elements of an *ELSET. A set that has all of them only because it names the sets of *ELEMENT
// (FreeCAD's Eall) names no part of the body, and these names are left out.
std::vector<std::int64_t> InpReader::listed_by(const std::string& set, const Rows& rows) const {
  auto own = element_sets_.ids(set, rows);
  auto united = element_sets_.ids(set, rows, &card_sets_);
  return united.size() == rows.size() && own.size() < united.size() ? own : united;
}

void InpReader::check_members(Notes* notes) const {
  const auto elements = element_sets_.missing(&card_sets_);
  if (!elements.empty()) {
    throw InvalidInput("*ELSET lists what is no element and no set of elements of this file: " +
                       listed(elements));
  }
  const auto nodes = node_sets_.missing();
  if (!nodes.empty()) {
    add_note(notes, "*NSET lists what is no node and no set of nodes of this file, left out: " +
                        listed(nodes));
  }
}

// Without sections, the sets become the regions if together they contain every tetrahedron exactly
// once (Gmsh's physical volumes).
// @param by_name  sets of *ELEMENT that an *ELSET names belong to it
bool InpReader::explicit_sets_share_out(std::vector<int>& region, bool by_name) {
  region.assign(tets_.tet_count(), -1);
  for (const std::string& name : element_sets_.names()) {
    const auto ids = by_name ? listed_by(name, tet_rows_) : element_sets_.ids(name, tet_rows_);
    for (const std::int64_t id : ids) {
      int& mine = region[static_cast<std::size_t>(tet_rows_.row(id))];
      if (mine >= 0) return false;
      mine = tets_.regions.index(name);
    }
  }
  return std::find(region.begin(), region.end(), -1) == region.end();
}

void InpReader::name_regions(Notes* notes) {
  std::vector<int> region;
  if (sections_.empty()) {
    if (!explicit_sets_share_out(region, false) && !explicit_sets_share_out(region, true)) return;
  } else {
    region.assign(tets_.tet_count(), -1);
    for (const std::string& name : sections_) {
      for (const std::int64_t id : elements_of("*SOLID SECTION", name)) {
        region[static_cast<std::size_t>(tet_rows_.row(id))] = tets_.regions.index(name);
      }
    }
  }
  const auto without = std::count(region.begin(), region.end(), -1);
  for (std::size_t t = 0; t < region.size(); ++t) {
    if (region[t] >= 0) tets_.set_region(t, region[t]);
  }
  if (without > 0) add_note(notes, fmt::to_string(without) + " elements without *SOLID SECTION");
}

void InpReader::add_faces(const SurfaceEntry& entry, std::int64_t element) {
  const std::int32_t row = tet_rows_.row(element);
  if (row < 0) return;
  const auto nodes = tets_.nodes(static_cast<std::size_t>(row));
  const int patch = tets_.patches.index(entry.patch);
  for (std::size_t f = 0; f < 4; ++f) {
    if (entry.face >= 0 && static_cast<std::size_t>(entry.face) != f) continue;
    const auto& [a, b, c] = kFaces.at(f);
    tets_.face(std::array{nodes[a], nodes[b], nodes[c]}, patch, entry.face >= 0);
  }
}

// Each triangle belongs to the first set that contains it. Sets of *ELSET come before sets of
// *ELEMENT.
void InpReader::name_triangles() {
  std::vector<bool> named(triangles_.size(), false);
  const auto name_all = [&](const std::string& name, const std::vector<std::int64_t>& ids) {
    for (const std::int64_t id : ids) {
      const auto row = static_cast<std::size_t>(triangle_rows_.row(id));
      if (!named[row]) tets_.face(triangles_[row].corners, tets_.patches.index(name));
      named[row] = true;
    }
  };
  for (const auto& name : element_sets_.names()) name_all(name, listed_by(name, triangle_rows_));
  for (const auto& name : card_sets_.names()) name_all(name, card_sets_.ids(name, triangle_rows_));
}

void InpReader::name_faces(Notes* notes) {
  for (const SurfaceEntry& entry : surface_) {
    if (entry.set.empty()) {
      add_faces(entry, entry.element);
      continue;
    }
    for (const std::int64_t id : elements_of("*SURFACE " + shown(entry.patch), entry.set)) {
      add_faces(entry, id);
    }
  }
  name_triangles();
  for (const std::string& name : node_sets_.names()) {
    tets_.node_set({name, node_sets_.ids(name, tets_.sorted_nodes())});
  }
  if (lines_ > 0) add_note(notes, fmt::to_string(lines_) + " line elements passed over");
}

mesh::TetMesh InpReader::mesh(Notes* notes) {
  for (Keyword keyword; deck_.next_keyword(keyword);) read(keyword);
  tet_rows_.sort("element");
  triangle_rows_.sort("element");
  check_members(notes);
  name_regions(notes);
  name_faces(notes);
  if (!unused_.empty()) {
    std::string names;
    for (const std::string& name : unused_) names += (names.empty() ? "*" : ", *") + name;
    add_note(notes, "not used (the study says it): " + names);
  }
  return tets_.mesh(notes);
}

}  // namespace

mesh::TetMesh parse_inp(std::string_view bytes, Notes* notes) {
  require(!trimmed(bytes).empty(), "the file is empty");
  return InpReader(bytes).mesh(notes);
}

}  // namespace chladni::io
