#include "study/named_materials.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace chladni::study {
namespace {

using Kind = TomlNode::Kind;
using Constants = std::vector<std::pair<std::string_view, std::string_view>>;

Constants isotropic(std::string_view modulus, std::string_view ratio, std::string_view density) {
  return {{"youngs_modulus", modulus}, {"poissons_ratio", ratio}, {"density", density}};
}

std::string folded(std::string_view name) {
  std::string text;
  for (const char letter : name) {
    if (letter == ' ' || letter == '-' || letter == '_') continue;
    text.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(letter))));
  }
  if (text.starts_with("aluminum")) text.replace(0, 8, "aluminium");
  return text;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& one : named_materials()) all.emplace_back(one.name);
  return all;
}

// A constant as a text with its unit, or as a number.
TomlNode constant(std::string_view written, const TomlNode& place) {
  const bool is_number = written.find(' ') == std::string_view::npos;
  auto node = node_at(place, is_number ? Kind::real : Kind::text);
  node.text = written;
  if (is_number) node.number = std::stod(node.text);
  return node;
}

void put(TomlNode& table, std::string_view key, TomlNode value) {
  if (member(table, key) != nullptr) return;
  table.members.push_back({std::string(key), value.line, value.column, std::move(value)});
}

bool complete(TomlNode& material, Problems& problems) {
  const auto* name = material.kind == Kind::table ? member(material, "name") : nullptr;
  if (name == nullptr || name->kind != Kind::text) return false;
  const auto* known = named_material(name->text);
  if (known == nullptr) {
    const auto nearest = nearest_name(name->text, names());
    problems.add(name->line, name->column,
                 "material \"" + name->text + "\" is not known; " +
                     (nearest.empty() ? "`chladni list materials` has the names"
                                      : "did you mean \"" + nearest + "\"?"));
    known = &named_materials().front();  // so that its constants are not called missing too
  }
  const TomlNode place = *name;
  const auto* symmetry = member(material, "symmetry");
  const bool is_another = symmetry != nullptr && symmetry->text != known->symmetry;
  const auto is_stated = [&](const auto& constant) {
    return constant.first == "density" || member(material, constant.first) != nullptr;
  };
  if (is_another && !std::ranges::all_of(known->constants, is_stated)) {
    problems.add(symmetry->line, symmetry->column,
                 "material \"" + place.text + "\" is " + std::string(known->symmetry) +
                     "; leave symmetry out, or give all constants but the density");
    return true;
  }
  auto kind = node_at(place, Kind::text);
  kind.text = known->symmetry;
  put(material, "symmetry", std::move(kind));
  for (const auto& [key, written] : known->constants) put(material, key, constant(written, place));
  return true;
}

}  // namespace

const std::vector<NamedMaterial>& named_materials() {
  static const std::vector<NamedMaterial> all = {
      {"aluminium 6061", "isotropic", isotropic("68.9 GPa", "0.33", "2700 kg/m^3"),
       "6061-T6; ASM, Metals Handbook vol. 2, 10th ed. 1990"},
      {"aluminium 7075", "isotropic", isotropic("71.7 GPa", "0.33", "2810 kg/m^3"),
       "7075-T6; ASM, Metals Handbook vol. 2, 10th ed. 1990"},
      {"steel", "isotropic", isotropic("210 GPa", "0.3", "7850 kg/m^3"),
       "structural steel; EN 1993-1-1:2005, 3.2.6, and EN 1991-1-1:2002"},
      {"stainless steel 304", "isotropic", isotropic("193 GPa", "0.29", "8000 kg/m^3"),
       "annealed; ASM, Metals Handbook vol. 1, 10th ed. 1990"},
      {"titanium grade 5", "isotropic", isotropic("113.8 GPa", "0.342", "4430 kg/m^3"),
       "Ti-6Al-4V, annealed; ASM, Titanium Alloys, 1994"},
      {"invar 36", "isotropic", isotropic("141 GPa", "0.29", "8050 kg/m^3"),
       "annealed; Carpenter Technology, data sheet Invar 36"},
      {"silicon",
       "cubic",
       {{"c11", "165.7 GPa"}, {"c12", "63.9 GPa"}, {"c44", "79.6 GPa"}, {"density", "2329 kg/m^3"}},
       "axes along <100>; Hopcroft, Nix and Kenny, J. MEMS 19, 2010"},
      {"silicon carbide", "isotropic", isotropic("410 GPa", "0.14", "3100 kg/m^3"),
       "sintered; Saint-Gobain, data sheet Hexoloy SA"},
      {"alumina", "isotropic", isotropic("370 GPa", "0.22", "3900 kg/m^3"),
       "99.5 %; CoorsTek, data sheet AD-995"},
      {"cordierite", "isotropic", isotropic("145 GPa", "0.31", "2550 kg/m^3"),
       "Kyocera, data sheet CO720"},
      {"zerodur", "isotropic", isotropic("90.3 GPa", "0.243", "2530 kg/m^3"),
       "Schott, catalogue Zerodur"},
      {"ule", "isotropic", isotropic("67.6 GPa", "0.17", "2210 kg/m^3"),
       "Corning, data sheet ULE 7972"},
      {"fused silica", "isotropic", isotropic("72.7 GPa", "0.16", "2200 kg/m^3"),
       "Corning, data sheet HPFS 7980"},
      {"bk7", "isotropic", isotropic("82 GPa", "0.206", "2510 kg/m^3"),
       "Schott, data sheet N-BK7"}};
  return all;
}

const NamedMaterial* named_material(std::string_view name) {
  const auto& all = named_materials();
  const auto found = std::ranges::find(all, folded(name),
                                       [](const NamedMaterial& one) { return folded(one.name); });
  return found == all.end() ? nullptr : &*found;
}

void put_material_names_into_tables(TomlNode& document) {
  auto* material = member(document, "material");
  if (material == nullptr || material->kind != Kind::text) return;
  auto table = node_at(*material, Kind::table);
  put(table, "name", *material);
  *material = std::move(table);
}

bool complete_materials(TomlNode& document, Problems& problems) {
  auto* material = member(document, "material");
  if (material == nullptr) return false;
  if (material->kind == Kind::table) return complete(*material, problems);
  bool any = false;
  for (auto& one : material->elements) any = complete(one, problems) || any;
  return any;
}

}  // namespace chladni::study
