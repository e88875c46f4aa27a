// The keys of the body and of its material.
#include <cmath>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

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
                table.name("poissons_ratio") + " is " + std::to_string(ratio) +
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

const Schema<StudyMaterial>& material_schema() {
  using P = StudyMaterial;
  static const Schema<P> schema = {
      "material",
      {text("region", &P::region, "of the body that is made of it",
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
