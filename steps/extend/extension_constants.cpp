// Constants of an orthotropic material that were calibrated, one by one.
#include <array>
#include <utility>

#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

// Scales one number of a key of the material.
std::string scale_one(const Extension& by, const char* key, std::size_t element) {
  for (const auto* table : study::tables_of(by.edit.tree(), "material")) {
    const auto* values = study::member(*table, key);
    if (values == nullptr) return std::string("the material has no ") + key;
    if (const auto* stated = study::member(*values, "value")) values = stated;
    if (values->elements.size() != 3) return std::string("there are not three of ") + key;
    scale(by, values->elements[element], 1.0 + by.number("relative"));
  }
  return {};
}

bool is_along_x(const Extension& by) { return by.chart.axis_u.cwiseAbs().x() > 0.5; }

std::string along_u(const Extension& by) {
  return scale_one(by, "youngs_modulus", is_along_x(by) ? 0 : 1);
}
std::string along_v(const Extension& by) {
  return scale_one(by, "youngs_modulus", is_along_x(by) ? 1 : 0);
}
std::string shear(const Extension& by) { return scale_one(by, "shear_modulus", 2); }

constexpr std::array<std::pair<std::string_view, Extend>, 3> kConstantEntries{
    {{"stiffness_along_u", along_u}, {"stiffness_along_v", along_v}, {"shear_stiffness", shear}}};

}  // namespace

Extend extend_constants(std::string_view effect) {
  for (const auto& [name, how] : kConstantEntries) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
