// material = { ... } or [[material]] of a study.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

bool all_known(const StudyMaterial& material) {
  for (const auto& [name, value] : material.constants) {
    if (std::isnan(value)) return false;
  }
  return true;
}

/// The constants of an orthotropic material come in threes.
Eigen::Vector3d three(const StudyMaterial& material, std::size_t first) {
  const auto& all = material.constants;
  return {all[first].second, all[first + 1].second, all[first + 2].second};
}

/// From the constants in the order of their schema, of which the density is the last.
fem::Material material_from(const StudyMaterial& material) {
  const auto& all = material.constants;
  const double density = all.back().second;
  if (material.symmetry == "cubic") {
    return fem::cubic(all[0].second, all[1].second, all[2].second, density);
  }
  if (material.symmetry == "orthotropic") {
    return fem::orthotropic({.youngs_modulus = three(material, 0),
                             .poissons_ratio = three(material, 3),
                             .shear_modulus = three(material, 6)},
                            density);
  }
  return fem::isotropic(all[0].second, all[1].second, density);
}

/// axes = three rows, the material's axes in the body's frame; angle = rotation about z.
std::optional<Eigen::Matrix3d> axes_of(TableReader& table) {
  const auto angle = table.quantity("angle", "rad");
  const TomlNode* node = table.find("axes");
  if (angle && node != nullptr) {
    table.wrong(*node, table.name("axes") + " and angle are both given; expected one of them");
  }
  if (angle) {
    return Eigen::AngleAxisd(*angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  if (node == nullptr) return std::nullopt;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  bool good = node->kind == TomlNode::Kind::array && node->elements.size() == 3;
  for (std::size_t k = 0; good && k < 3; ++k) {
    const auto& row = node->elements[k].elements;
    good = row.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      axes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = row[i].number;
    }
    axes.col(static_cast<Eigen::Index>(k)).normalize();
  }
  good = good && axes.allFinite() && (axes.transpose() * axes).isIdentity(1e-9) &&
         axes.determinant() > 0.0;
  if (good) return axes;
  table.wrong(*node, table.name("axes") +
                         " must be three right-handed directions at right angles, such as "
                         "[[1, 1, 0], [-1, 1, 0], [0, 0, 1]]");
  return std::nullopt;
}

void read_constants(TableReader& table, StudyMaterial& out) {
  constants_schema(out.symmetry).read(table, out);
  if (all_known(out)) out.material = material_from(out);
  const auto axes = axes_of(table);
  out.is_turned = axes.has_value();
  if (axes && all_known(out)) out.material = fem::turned(out.material, *axes);
}

StudyMaterial material_of(TableReader& table, const TomlNode& node) {
  StudyMaterial out;
  out.symmetry = "isotropic";
  material_schema().read(table, out);
  static_cast<void>(table.text("name"));  // its constants are there by now
  try {
    read_constants(table, out);
  } catch (const InvalidInput& e) {
    table.wrong(node, table.path() + ": " + e.what());
  }
  table.refuse_unknown();
  return out;
}

void warn(Study& study, const TomlNode& node, const std::string& message) {
  study.warnings.push_back(study.file.string() + ":" + fmt::to_string(node.line) + ":" +
                           fmt::to_string(node.column) + ": " + message);
}

/// Warns of a value that no solid has: usually the prefix of a unit is missing.
void check_plausible(Study& study, const StudyMaterial& material, const TomlNode& node) {
  for (const auto& [name, value] : material.constants) {
    const bool modulus = name.starts_with("youngs_modulus") || name.starts_with("shear_modulus") ||
                         name.starts_with("c1") || name.starts_with("c4");
    const auto text = [&, n = name, v = value](const char* rest) {
      char digits[32];
      static_cast<void>(std::snprintf(digits, sizeof digits, "%.4g", v));
      return "is the unit right? " + n + " is " + digits + rest;
    };
    if (modulus && (value < 1e6 || value > 2e12)) {
      warn(study, node, text(" Pa; aluminium has 70e9 Pa, steel 210e9 Pa (is \"GPa\" meant?)"));
    }
    if (name == "density" && (value < 10.0 || value > 23000.0)) {
      warn(study, node, text(" kg/m^3; aluminium has 2700, steel 7850 kg/m^3"));
    }
    if (name.starts_with("poissons_ratio") && value > 0.45 && material.symmetry == "isotropic") {
      warn(study, node,
           name +
               " is above 0.45: nearly incompressible, elements of order 1 and 2 "
               "lock; use order = 3 and compare two meshes");
    }
  }
}

}  // namespace

void read_materials(TableReader& root, Study& study) {
  const TomlNode* node = root.find("material");
  if (node == nullptr) {
    root.missing(
        "material",
        "{ youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\" }");
    return;
  }
  std::vector<TableReader> tables;
  if (node->kind == TomlNode::Kind::array) {
    tables = root.tables("material");
  } else if (auto one = root.table("material")) {
    tables.push_back(*one);
  }
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const TomlNode& place = node->kind == TomlNode::Kind::array ? node->elements[i] : *node;
    const auto material = material_of(tables[i], place);
    for (const auto& other : study.materials) {
      if (other.region == material.region) {
        root.wrong(place, "two materials for " + (material.region.empty()
                                                      ? std::string("every region")
                                                      : "region \"" + material.region + "\""));
      }
    }
    check_plausible(study, material, place);
    study.materials.push_back(material);
  }
}

}  // namespace chladni::study
