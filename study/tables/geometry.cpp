// geometry = { ... } and mesh = { ... } of a study.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

mesh::Plate plate_of(TableReader& table) {
  mesh::Plate plate;
  plate.length = table.required_quantity("length", "m", Sign::positive);
  plate.width = table.required_quantity("width", "m", Sign::positive);
  plate.thickness = table.required_quantity("thickness", "m", Sign::positive);
  return plate;
}

mesh::Disc disc_of(TableReader& table) {
  mesh::Disc disc;
  disc.diameter = table.required_quantity("diameter", "m", Sign::positive);
  disc.thickness = table.required_quantity("thickness", "m", Sign::positive);
  disc.hole_diameter = table.quantity("hole_diameter", "m", Sign::not_negative).value_or(0.0);
  return disc;
}

mesh::Sphere sphere_of(TableReader& table) {
  mesh::Sphere sphere;
  sphere.diameter = table.required_quantity("diameter", "m", Sign::positive);
  sphere.hole_diameter = table.quantity("hole_diameter", "m", Sign::not_negative).value_or(0.0);
  return sphere;
}

mesh::Quadrilateral quadrilateral_of(TableReader& table) {
  mesh::Quadrilateral plate;
  plate.corners.setZero();
  plate.thickness = table.required_quantity("thickness", "m", Sign::positive);
  const TomlNode* corners = table.find("corners");
  const std::string expected =
      "four corners counter-clockwise, such as [[\"0 m\", \"0 m\"], [\"2 m\", \"0 m\"], ...]";
  if (corners == nullptr) {
    table.missing("corners", expected);
    return plate;
  }
  bool good = corners->kind == TomlNode::Kind::array && corners->elements.size() == 4;
  for (std::size_t k = 0; good && k < 4; ++k) {
    const auto& corner = corners->elements[k].elements;
    good = corner.size() == 2;
    for (std::size_t i = 0; good && i < 2; ++i) {
      plate.corners(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
          table.value_of(corner[i], table.name("corners"), "m", Sign::any);
    }
  }
  if (!good) table.wrong(*corners, table.name("corners") + " must be " + expected);
  return plate;
}

void read_pockets(TableReader& table, mesh::WaferTable& wafer_table) {
  if (const auto pockets = table.quantities("pockets", "1", 2, Sign::not_negative)) {
    const bool whole = (pockets->array() == pockets->array().round()).all();
    if (whole && pockets->maxCoeff() <= 200.0) {
      wafer_table.pockets_x = static_cast<int>((*pockets)(0));
      wafer_table.pockets_y = static_cast<int>((*pockets)(1));
    } else {
      table.wrong(*table.find("pockets"),
                  table.name("pockets") + " must be two whole numbers up to 200, such as [9, 9]");
    }
  }
  const bool has_pockets = wafer_table.pockets_x > 0 && wafer_table.pockets_y > 0;
  wafer_table.face_sheet = table.quantity("face_sheet", "m", Sign::positive)
                               .value_or(has_pockets ? 0.0 : wafer_table.height);
  wafer_table.rib = table.quantity("rib", "m", Sign::positive).value_or(0.0);
  wafer_table.rim = table.quantity("rim", "m", Sign::positive).value_or(0.0);
  if (has_pockets && !table.has("face_sheet"))
    table.missing("face_sheet", "a length, since there are pockets");
  if (has_pockets && !table.has("rib")) table.missing("rib", "a length, since there are pockets");
}

void read_bores(TableReader& table, mesh::WaferTable& wafer_table) {
  for (auto& one : table.tables("bores")) {
    mesh::Bore bore;
    if (!one.has("at")) one.missing("at", "two lengths such as [\"20 mm\", \"0 mm\"]");
    bore.centre = one.quantities("at", "m", 2).value_or(Eigen::Vector2d::Zero());
    bore.diameter = one.required_quantity("diameter", "m", Sign::positive);
    bore.depth = one.quantity("depth", "m", Sign::not_negative).value_or(0.0);
    one.refuse_unknown();
    wafer_table.bores.push_back(bore);
  }
}

mesh::WaferTable wafer_table_of(TableReader& table) {
  mesh::WaferTable wafer_table;
  wafer_table.length = table.required_quantity("length", "m", Sign::positive);
  wafer_table.width = table.required_quantity("width", "m", Sign::positive);
  wafer_table.height = table.required_quantity("height", "m", Sign::positive);
  read_pockets(table, wafer_table);
  if (const auto cutout = table.quantities("edge_cutout", "m", 2, Sign::not_negative)) {
    wafer_table.edge_cutout_length = (*cutout)(0);
    wafer_table.edge_cutout_depth = (*cutout)(1);
  }
  wafer_table.corner_cutout =
      table.quantity("corner_cutout", "m", Sign::not_negative).value_or(0.0);
  read_bores(table, wafer_table);
  if (auto wafer = table.table("wafer")) {
    wafer_table.wafer_diameter = wafer->required_quantity("diameter", "m", Sign::positive);
    wafer_table.wafer_thickness = wafer->required_quantity("thickness", "m", Sign::positive);
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
  const bool needs = std::find(kNeedUnit.begin(), kNeedUnit.end(), ending) != kNeedUnit.end();
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

FileGeometry file_of(TableReader& table, const StudyFolder& folder) {
  FileGeometry geometry;
  const auto text = table.text("file");
  geometry.unit = table.text("unit").value_or("");
  if (!text) return geometry;
  try {
    geometry.file = folder.resolved(*text);
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
  if (kind == "disc") return disc_of(table);
  if (kind == "sphere") return sphere_of(table);
  if (kind == "quadrilateral") return quadrilateral_of(table);
  if (kind == "wafer_table") return wafer_table_of(table);
  return plate_of(table);
}

}  // namespace

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
      study.geometry.body = file_of(*table, folder);
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
                 "geometry holds " + std::to_string(found) + " bodies; expected one: " + expected);
  }
}

void read_mesh_part(TableReader& root, Study& study) {
  auto table = root.table("mesh");
  if (!table) return;
  mesh_schema().read(*table, study.mesh);
  table->refuse_unknown();
}

}  // namespace chladni::study
