// geometry = { ... } and mesh = { ... } of a study.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

mesh::WaferTable wafer_table_of(TableReader& table) {
  auto wafer_table = read_part(table, wafer_table_schema());
  const bool has_pockets = wafer_table.pockets_x > 0 && wafer_table.pockets_y > 0;
  if (!table.has("face_sheet")) {
    if (has_pockets) table.missing("face_sheet", "a length, since there are pockets");
    wafer_table.face_sheet = has_pockets ? 0.0 : wafer_table.height;
  }
  if (has_pockets && !table.has("rib")) table.missing("rib", "a length, since there are pockets");
  if (auto wafer = table.table("wafer")) {
    wafer_schema().read(*wafer, wafer_table);
    wafer->refuse_unknown();
  }
  return wafer_table;
}

constexpr std::array kNeedUnit = {".stl", ".off", ".ply", ".obj", ".msh", ".inp", ".vtu"};
constexpr std::array kCarryUnit = {".step", ".stp"};

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_unit(TableReader& table, const FileGeometry& geometry) {
  const std::string ending = ending_of(geometry.file);
  const bool needs = needs_unit(geometry.file);
  const bool carries = std::find(kCarryUnit.begin(), kCarryUnit.end(), ending) != kCarryUnit.end();
  if (!needs && !carries) {
    table.wrong(*table.find("file"),
                "geometry.file ends in \"" + ending +
                    "\"; expected .step .stp .stl .off .ply .obj (closed surface) or .msh .inp "
                    ".vtu (tetrahedra)");
  }
  if (needs && geometry.unit.empty()) {
    table.missing("unit", "the length unit of a " + ending + " file, such as unit = \"mm\"");
  }
  if (geometry.unit.empty()) return;
  try {
    static_cast<void>(unit_factor(geometry.unit, "m"));
  } catch (const InvalidInput& e) {
    table.wrong(*table.find("unit"), table.name("unit") + ": " + e.what());
  }
}

FileGeometry file_of(TableReader& table, const StudyFolder& folder, Study& study) {
  FileGeometry geometry;
  const auto text = table.text("file");
  geometry.unit = table.text("unit").value_or("");
  if (!text) return geometry;
  try {
    geometry.file = folder.resolved(*text);
    const TomlNode& node = *table.find("file");
    study.files.push_back({table.name("file"), geometry.file, node.line, node.column});
  } catch (const InvalidInput& e) {
    table.wrong(*table.find("file"), e.what());
    return geometry;
  }
  if (!std::filesystem::exists(geometry.file)) {
    table.wrong(*table.find("file"), "geometry.file \"" + *text + "\" does not exist (looked for " +
                                         geometry.file.string() + ")");
    return geometry;
  }
  check_unit(table, geometry);
  return geometry;
}

constexpr std::array kKinds = {"plate",  "beam",        "disc", "quadrilateral",
                               "sphere", "wafer_table", "file"};

decltype(Geometry::body) parametric_of(const std::string& kind, TableReader& table) {
  if (kind == "disc") return read_part(table, disc_schema());
  if (kind == "sphere") return read_part(table, sphere_schema());
  if (kind == "quadrilateral") return read_part(table, quadrilateral_schema());
  if (kind == "wafer_table") return wafer_table_of(table);
  return read_part(table, plate_schema());
}

}  // namespace

bool needs_unit(const std::filesystem::path& file) {
  return std::find(kNeedUnit.begin(), kNeedUnit.end(), ending_of(file)) != kNeedUnit.end();
}

void read_geometry_part(TableReader& root, const StudyFolder& folder, Study& study) {
  const std::string expected =
      "{ plate = { ... } }, { beam = { ... } }, { disc = { ... } }, "
      "{ wafer_table = { ... } } or "
      "{ file = \"table.step\" }";
  if (!root.has("geometry")) root.missing("geometry", expected);
  auto table = root.table("geometry");
  if (!table) return;
  int found = 0;
  for (const auto& kind : kKinds) {
    if (!table->has(kind)) {
      table->find(kind);
      continue;
    }
    ++found;
    study.geometry.kind = kind;
    if (study.geometry.kind == "file") {
      study.geometry.body = file_of(*table, folder, study);
      continue;
    }
    if (auto body = table->table(kind)) {
      study.geometry.body = parametric_of(study.geometry.kind, *body);
      body->refuse_unknown();
    }
  }
  table->refuse_unknown();
  if (found != 1) {
    table->wrong(*root.find("geometry"),
                 "geometry holds " + fmt::to_string(found) + " bodies; expected one: " + expected);
  }
}

void read_mesh_part(TableReader& root, Study& study) {
  auto table = root.table("mesh");
  if (!table) return;
  mesh_schema().read(*table, study.mesh);
  table->refuse_unknown();
}

}  // namespace chladni::study
