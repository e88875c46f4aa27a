// Causes in the body as a whole, with keys that its shape or its material decides.
#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "stage/plane_stress.h"
#include "steps/extend/extended_tables.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

// True if the chart is seen from above or from below.
bool looks_along_z(const Extension& by) {
  return by.chart.axis_u.cross(by.chart.axis_v).cwiseAbs().z() > 1.0 - 1e-9;
}

// Scales all dimensions along z.
void scale_heights(const Extension& by, const study::TomlNode& body, double factor) {
  for (const auto* key : {"thickness", "height", "face_sheet"}) {
    if (const auto* value = study::member(body, key)) scale(by, *value, factor);
  }
  if (const auto* wafer = study::member(body, "wafer")) {
    if (const auto* value = study::member(*wafer, "thickness")) scale(by, *value, factor);
  }
  for (const auto* bore : study::tables_of(body, "bores")) {
    if (const auto* value = study::member(*bore, "depth")) scale(by, *value, factor);
  }
}

std::string thickness(const Extension& by) {
  const auto* geometry = study::member(by.edit.tree(), "geometry");
  if (by.study.geometry.kind == "file") return "the body's thickness is in a file of geometry";
  if (by.study.geometry.kind == "sphere") return "a sphere has no thickness";
  if (!looks_along_z(by)) return kOtherChart;
  scale_heights(by, *study::member(*geometry, by.study.geometry.kind), 1.0 + by.number("relative"));
  return {};
}

// Scales the size seen along z. Holes in the body keep their size.
std::string size_error(const Extension& by) {
  const auto& kind = by.study.geometry.kind;
  if (kind == "file") return "the body's size is in a file of geometry";
  if (kind == "sphere") return "a sphere has no size seen along z alone";
  if (!looks_along_z(by)) return kOtherChart;
  const auto* body = study::member(*study::member(by.edit.tree(), "geometry"), kind);
  bool is_scaled = false;
  for (const auto* key : {"length", "width", "diameter"}) {
    if (const auto* value = study::member(*body, key)) {
      scale(by, *value, 1.0 + by.number("relative"));
      is_scaled = true;
    }
  }
  return is_scaled ? "" : "the size of a " + kind + " is not one number of the study";
}

std::string gigapascals(double value) { return study::toml_text(digits(1e-9 * value) + " GPa"); }

// True if strains along the axes and shears are not coupled with each other, nor two shears.
bool is_orthotropic(const Eigen::Matrix<double, 6, 6>& stiffness) {
  Eigen::Matrix<double, 6, 6> rest = stiffness;
  rest.topLeftCorner<3, 3>().setZero();
  rest.diagonal().setZero();
  return rest.cwiseAbs().maxCoeff() <= 1e-9 * stiffness.cwiseAbs().maxCoeff();
}

void write_orthotropic(const Extension& by, const study::TomlNode& table,
                       const Eigen::Matrix<double, 6, 6>& stiffness) {
  const Eigen::Matrix<double, 6, 6> compliance = stiffness.inverse();
  const auto modulus = [&](Eigen::Index i) { return 1.0 / compliance(i, i); };
  const auto ratio = [&](Eigen::Index i, Eigen::Index j) {
    return digits(-compliance(i, j) / compliance(i, i));
  };
  const auto set = [&](const char* key, const std::string& written) {
    const auto* before = study::member(table, key);
    by.edit.set(table, "density", key, written,
                by.comment(before == nullptr ? std::string_view() : by.edit.written(*before)));
  };
  set("symmetry", study::toml_text("orthotropic"));
  set("youngs_modulus", fmt::format("[{}, {}, {}]", gigapascals(modulus(0)),
                                    gigapascals(modulus(1)), gigapascals(modulus(2))));
  set("poissons_ratio", fmt::format("[{}, {}, {}]", ratio(1, 2), ratio(0, 2), ratio(0, 1)));
  set("shear_modulus", fmt::format("[{}, {}, {}]", gigapascals(modulus(3)), gigapascals(modulus(4)),
                                   gigapascals(modulus(5))));
}

// Changes orthotropy by plane-stress constants: the increase of stiffness along u and in shear
// (stage/diagnosis_structure.h).
std::string orthotropy(const Extension& by) {
  Eigen::Index u = 0;
  Eigen::Index v = 0;
  if (by.chart.axis_u.cwiseAbs().maxCoeff(&u) != 1.0 ||
      by.chart.axis_v.cwiseAbs().maxCoeff(&v) != 1.0) {
    return "the chart does not lie along the body's axes";
  }
  const auto tables = study::tables_of(by.edit.tree(), "material");
  for (std::size_t m = 0; m < tables.size(); ++m) {
    const auto& table = *tables[m];
    if (by.study.materials.at(m).symmetry == "cubic") return "a cubic material has one stiffness";
    if (study::member(table, "angle") != nullptr || study::member(table, "axes") != nullptr) {
      return "the material's axes do not lie along the body's";
    }
    Eigen::Matrix<double, 6, 6> stiffness = by.study.materials[m].material.stiffness;
    const Eigen::Matrix3d constants = stage::plane_stress(stiffness, u, v);
    stiffness(u, u) += by.number("along_u") * constants(0, 0);
    stiffness(stage::shear_of(u, v), stage::shear_of(u, v)) += by.number("shear") * constants(2, 2);
    require(is_orthotropic(stiffness), "orthotropy of a material that shears when it is stretched");
    write_orthotropic(by, table, stiffness);
  }
  return {};
}

constexpr std::array<std::pair<std::string_view, Extend>, 3> kBodyEntries{
    {{"thickness", thickness}, {"size_error", size_error}, {"orthotropy", orthotropy}}};

}  // namespace

Extend extend_body(std::string_view effect) {
  for (const auto& [name, how] : kBodyEntries) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
