// Materials by their names, with the sources of their constants.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "study/problems.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

/// Typical constants at room temperature, as a study writes them.
struct NamedMaterial {
  std::string_view name;
  std::string_view symmetry;                                             ///< "isotropic" or "cubic"
  std::vector<std::pair<std::string_view, std::string_view>> constants;  ///< key, value as TOML
  std::string_view source;
};

[[nodiscard]] const std::vector<NamedMaterial>& named_materials();

/// The one of that name, without regard to capitals, "-" and "_"; null: there is none. "aluminum"
/// is aluminium.
[[nodiscard]] const NamedMaterial* named_material(std::string_view name);

/// material = "zerodur" becomes { name = "zerodur" }. To be called before documents are merged, so
/// that one that extends another may change a constant.
void put_material_names_into_tables(TomlNode& document);

/// Gives each material with a name the constants that it does not state itself. A name that is not
/// known is a problem. Returns true if there was one with a name.
bool complete_materials(TomlNode& document, Problems& problems);

}  // namespace chladni::study
