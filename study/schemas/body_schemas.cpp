// The keys of the body and of its material.
#include <fmt/format.h>

#include <cmath>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

void read_corners(TableReader& table, mesh::Quadrilateral& plate) {
  plate.corners.setZero();
  const TomlNode* corners = table.find("corners");
  const std::string expected =
      "four corners counter-clockwise, such as [[\"0 m\", \"0 m\"], [\"2 m\", \"0 m\"], ...]";
  if (corners == nullptr) {
    table.missing("corners", expected);
    return;
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
}

constexpr int kMostPockets = 200;  // along a side

void read_pockets(TableReader& table, mesh::WaferTable& wafer_table) {
  const auto pockets = table.quantities("pockets", "1", 2, Sign::not_negative);
  if (!pockets) return;
  const bool whole_numbers = (pockets->array() == pockets->array().round()).all();
  if (whole_numbers && pockets->maxCoeff() <= kMostPockets) {
    wafer_table.pockets_x = static_cast<int>((*pockets)(0));
    wafer_table.pockets_y = static_cast<int>((*pockets)(1));
  } else {
    table.wrong(*table.find("pockets"),
                fmt::format("{} must be two whole numbers up to {}, such as [9, 9]",
                            table.name("pockets"), kMostPockets));
  }
}

void read_edge_cutout(TableReader& table, mesh::WaferTable& wafer_table) {
  if (const auto cutout = table.quantities("edge_cutout", "m", 2, Sign::not_negative)) {
    wafer_table.edge_cutout_length = (*cutout)(0);
    wafer_table.edge_cutout_depth = (*cutout)(1);
  }
}

void read_bores(TableReader& table, mesh::WaferTable& wafer_table) {
  for (auto& one : table.tables("bores")) {
    wafer_table.bores.push_back(read_part(one, bore_schema()));
    one.refuse_unknown();
  }
}

io::Json bores_json(const mesh::WaferTable& wafer_table) {
  io::JsonArray bores;
  for (const auto& bore : wafer_table.bores) bores.emplace_back(bore_schema().json(bore));
  return bores;
}

/// A constant of a material. study.json has it among the others.
Key<StudyMaterial> constant(const std::string& name, const std::string& si_unit, Sign sign,
                            const std::string& meaning) {
  return {.text = {name, expected_quantity(si_unit, sign), "needed", meaning},
          .json_name = name,
          .read =
              [=](TableReader& table, StudyMaterial& material) {
                material.constants.emplace_back(name, table.required_quantity(name, si_unit, sign));
              },
          .json = not_shown<StudyMaterial>};
}

Key<StudyMaterial> density() {
  return constant("density", "kg/m^3", Sign::positive, "mass over volume");
}

void read_poissons_ratio(TableReader& table, StudyMaterial& material) {
  double ratio = table.required_quantity("poissons_ratio", "1");
  if (!std::isnan(ratio) && !(ratio > -1.0 && ratio < 0.5)) {
    table.wrong(*table.find("poissons_ratio"),
                table.name("poissons_ratio") + " is " + fmt::format("{:.6g}", ratio) +
                    "; expected more than -1 and less than 0.5 (0.33 for aluminium)");
    ratio = std::nan("");
  }
  material.constants.emplace_back("poissons_ratio", ratio);
}

/// Three constants of one key; those of "youngs_modulus" are "youngs_modulus_1" and so on.
Key<StudyMaterial> three(const std::string& name, const std::string& si_unit, Sign sign,
                         const std::string& order, const std::string& meaning) {
  const auto read = [=](TableReader& table, StudyMaterial& material) {
    if (!table.has(name)) table.missing(name, "three values, in the order " + order);
    const auto values = table.quantities(name, si_unit, 3, sign);
    for (int i = 0; i < 3; ++i) {
      material.constants.emplace_back(fmt::format("{}_{}", name, i + 1),
                                      values ? (*values)(i) : std::nan(""));
    }
  };
  return {.text = {name, "three, each " + expected_quantity(si_unit, sign), "needed",
                   fmt::format("{}: {}", meaning, order)},
          .json_name = name,
          .read = read,
          .json = not_shown<StudyMaterial>};
}

const Schema<StudyMaterial>& isotropic_schema() {
  using P = StudyMaterial;
  static const Schema<P> schema = {
      "material",
      {constant("youngs_modulus", "Pa", Sign::positive, "Young's modulus"),
       {.text = {"poissons_ratio", "a number, more than -1 and less than 0.5", "needed",
                 "Poisson's ratio"},
        .json_name = "poissons_ratio",
        .read = read_poissons_ratio,
        .json = not_shown<P>},
       density()}};
  return schema;
}

const Schema<StudyMaterial>& cubic_schema() {
  static const Schema<StudyMaterial> schema = {
      "material",
      {constant("c11", "Pa", Sign::positive, "stiffness along an axis"),
       constant("c12", "Pa", Sign::any, "stiffness between two axes"),
       constant("c44", "Pa", Sign::positive, "stiffness in shear"), density()}};
  return schema;
}

const Schema<StudyMaterial>& orthotropic_schema() {
  static const Schema<StudyMaterial> schema = {
      "material",
      {three("youngs_modulus", "Pa", Sign::positive, "E1 E2 E3", "Young's moduli"),
       three("poissons_ratio", "1", Sign::any, "nu23 nu13 nu12", "Poisson's ratios"),
       three("shear_modulus", "Pa", Sign::positive, "G23 G13 G12", "shear moduli"), density()}};
  return schema;
}

}  // namespace

const Schema<mesh::Plate>& plate_schema() {
  using P = mesh::Plate;
  static const Schema<P> schema = {
      "geometry.plate",
      {needed("length", "m", &P::length, "along x"), needed("width", "m", &P::width, "along y"),
       needed("thickness", "m", &P::thickness, "along z")}};
  return schema;
}

const Schema<mesh::Disc>& disc_schema() {
  using P = mesh::Disc;
  static const Schema<P> schema = {
      "geometry.disc",
      {needed("diameter", "m", &P::diameter, "of the disc"),
       needed("thickness", "m", &P::thickness, "along z"),
       quantity("hole_diameter", "m", Sign::not_negative, &P::hole_diameter,
                "of a hole in its middle", "none")}};
  return schema;
}

const Schema<mesh::Sphere>& sphere_schema() {
  using P = mesh::Sphere;
  static const Schema<P> schema = {"geometry.sphere",
                                   {needed("diameter", "m", &P::diameter, "of the sphere"),
                                    quantity("hole_diameter", "m", Sign::not_negative,
                                             &P::hole_diameter, "of a hollow in it", "none")}};
  return schema;
}

const Schema<mesh::Quadrilateral>& quadrilateral_schema() {
  using P = mesh::Quadrilateral;
  static const Schema<P> schema = {
      "geometry.quadrilateral",
      {{.text = {"corners", "four pairs of quantities in m, counter-clockwise, convex", "needed",
                 "seen from above"},
        .json_name = "corners_m",
        .read = read_corners,
        .json = [](const P& plate) { return io::Json::rows(Eigen::MatrixXd(plate.corners)); }},
       needed("thickness", "m", &P::thickness, "along z")}};
  return schema;
}

const Schema<mesh::Bore>& bore_schema() {
  using P = mesh::Bore;
  static const Schema<P> schema = {
      "[geometry.wafer_table.bores]",
      {{.text = {"at", "two quantities in m", "needed", "of its axis, along z"},
        .json_name = "at_m",
        .read =
            [](TableReader& table, P& bore) {
              if (!table.has("at")) {
                table.missing("at", "two lengths such as [\"20 mm\", \"0 mm\"]");
              }
              bore.centre = table.quantities("at", "m", 2).value_or(Eigen::Vector2d::Zero());
            },
        .json = [](const P& bore) { return io::Json(bore.centre); }},
       needed("diameter", "m", &P::diameter, "of the bore"),
       quantity("depth", "m", Sign::not_negative, &P::depth, "from below", "through")}};
  return schema;
}

const Schema<mesh::WaferTable>& wafer_table_schema() {
  using P = mesh::WaferTable;
  static const Schema<P> schema = {
      "geometry.wafer_table",
      {needed("length", "m", &P::length, "along x"),
       needed("width", "m", &P::width, "along y"),
       needed("height", "m", &P::height, "along z"),
       quantity("face_sheet", "m", Sign::positive, &P::face_sheet, "thickness above the pockets",
                "needed with pockets"),
       {.text = {"pockets", fmt::format("two whole numbers up to {}", kMostPockets),
                 "a plain block", "cut from below, along x and y"},
        .json_name = "pockets",
        .read = read_pockets,
        .json =
            [](const P& table) {
              return io::JsonArray{table.pockets_x, table.pockets_y};
            }},
       quantity("rib", "m", Sign::positive, &P::rib, "thickness between two pockets",
                "needed with pockets"),
       quantity("rim", "m", Sign::positive, &P::rim, "thickness of the outer wall",
                "that of a rib"),
       {.text = {"edge_cutout[0]", expected_quantity("m", Sign::not_negative), "no cut-out",
                 "of a cut-out in the middle of each edge, along the edge"},
        .json_name = "edge_cutout_length_m",
        .read = read_edge_cutout,
        .json = [](const P& table) { return io::Json(table.edge_cutout_length); }},
       special<P>({"edge_cutout[1]", expected_quantity("m", Sign::not_negative), "no cut-out",
                   "of the same, into the body"},
                  "edge_cutout_depth_m",
                  [](const P& table) { return io::Json(table.edge_cutout_depth); }),
       quantity("corner_cutout", "m", Sign::not_negative, &P::corner_cutout,
                "side of a square cut from each corner"),
       {.text = {"bores", "tables with at, diameter, depth", "none", "round holes along z"},
        .json_name = "bores",
        .read = read_bores,
        .json = bores_json}}};
  return schema;
}

const Schema<mesh::WaferTable>& wafer_schema() {
  using P = mesh::WaferTable;
  const auto of_wafer = [](Key<P> key) {
    key.json_name = "wafer_" + key.json_name;
    return key;
  };
  static const Schema<P> schema = {
      "geometry.wafer_table.wafer",
      {of_wafer(needed("diameter", "m", &P::wafer_diameter, "of a wafer bonded on top")),
       of_wafer(needed("thickness", "m", &P::wafer_thickness, "of the wafer"))}};
  return schema;
}

const Schema<FileGeometry>& file_schema() {
  using P = FileGeometry;
  static const Schema<P> schema = {
      "geometry",
      {special<P>({"file", "a path", "needed, or a body by its dimensions",
                   "a surface or tetrahedra, see `chladni list formats`"},
                  "file", [](const P& plan) { return io::Json(plan.file.filename().string()); }),
       special<P>({"unit", "a unit of length", "that of a STEP file; else needed",
                   "of the numbers in the file"},
                  "unit", [](const P& plan) { return io::Json(plan.unit); })}};
  return schema;
}

const Schema<StudyMaterial>& material_schema() {
  using P = StudyMaterial;
  static const Schema<P> schema = {
      "material",
      {special<P>({"name", "a name of `chladni list materials`", "none",
                   "gives the constants that are not stated; also `material = \"zerodur\"`"},
                  "name", not_shown<P>),
       text("region", &P::region, "of the body that is made of it",
            "every region without a material of its own"),
       choice("symmetry", {"isotropic", "cubic", "orthotropic"}, &P::symmetry,
              "says which constants are needed", quoted({"isotropic"})),
       special<P>({"angle", "a quantity in rad", "0", "of the material's axes about z"}, "angle",
                  not_shown<P>),
       special<P>({"axes", "three right-handed directions at right angles", "x, y, z",
                   "the material's axes in the body's frame, instead of angle"},
                  "axes", not_shown<P>)}};
  return schema;
}

const Schema<StudyMaterial>& constants_schema(const std::string& symmetry) {
  if (symmetry == "cubic") return cubic_schema();
  return symmetry == "orthotropic" ? orthotropic_schema() : isotropic_schema();
}

}  // namespace chladni::study
