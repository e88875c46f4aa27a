#include "study/schemas/known.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/quantity.h"

namespace chladni::study {
namespace {

using diagnosis::CalibratedConstant;
using Kind = CalibratedConstant::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 3> kStatements{
    {{"within", Kind::known}, {"measured", Kind::measured}, {"unknown", Kind::unknown}}};

bool states_its_deviation(const TomlNode& node) {
  return node.kind == TomlNode::Kind::table && member(node, "value") != nullptr &&
         std::ranges::any_of(kStatements,
                             [&](const auto& one) { return member(node, one.first) != nullptr; });
}

/// Takes such tables out of a tree.
class Taker {
 public:
  explicit Taker(Problems& problems) : problems_(problems) {}

  void walk(TomlNode& node, const std::string& key, int element = -1) {
    if (states_its_deviation(node)) {
      take(node, key, element);
      return;
    }
    for (auto& one : node.members) {
      if (key.empty() && one.key == "expect") continue;
      walk(one.value, key.empty() ? one.key : key + "." + one.key);
    }
    for (std::size_t i = 0; i < node.elements.size(); ++i) {
      walk(node.elements[i], fmt::format("{}[{}]", key, i), static_cast<int>(i));
    }
  }
  [[nodiscard]] std::vector<KnownNumber> taken() { return std::move(all_); }

 private:
  void take(TomlNode& node, const std::string& key, int element) {
    KnownNumber known{key, element, false, node.line, node.column, 0.0, Kind::known};
    int statements = 0;
    for (const auto& one : node.members) {
      const auto* found = std::ranges::find(
          kStatements, one.key, [](const auto& statement) { return std::string(statement.first); });
      if (found != kStatements.end()) {
        ++statements;
        known.kind = found->second;
        known.deviation = deviation(one, key);
      } else if (one.key != "value") {
        problems_.add(one.line, one.column,
                      fmt::format("{} has an unknown key \"{}\"; expected value and one of within, "
                                  "measured, unknown",
                                  key, one.key));
      }
    }
    if (statements > 1) {
      problems_.add(node.line, node.column,
                    key + " states more than one of within, measured, unknown; expected one");
    }
    TomlNode value = *member(node, "value");
    known.of_array = value.kind == TomlNode::Kind::array;
    node = std::move(value);
    all_.push_back(std::move(known));
  }

  double deviation(const TomlMember& one, const std::string& key) {
    const auto& node = one.value;
    const auto wrong = [&](const std::string& expected) {
      problems_.add(
          node.line, node.column,
          fmt::format("{}.{} is {}; expected {}", key, one.key, description(node), expected));
      return 0.0;
    };
    if (one.key == "unknown") {
      return node.kind == TomlNode::Kind::truth && node.truth ? 0.0 : wrong("true");
    }
    constexpr auto kExpected = "a part of the value above 0 such as \"15 %\"";
    if (node.kind != TomlNode::Kind::text || node.text.find('%') == std::string::npos) {
      return wrong(kExpected);
    }
    try {
      const double part = chladni::quantity(node.text, "1");
      return part > 0.0 && part < 1.0 ? part : wrong(kExpected);
    } catch (const InvalidInput&) {
      return wrong(kExpected);
    }
  }

  Problems& problems_;
  std::vector<KnownNumber> all_;
};

/// A constant of the study; none if the key is no constant that can be calibrated.
struct Constant {
  std::string unit, effect;
  double value = 0.0;
};

std::optional<Constant> of_material(const StudyMaterial& material, const std::string& name,
                                    int element) {
  const auto value = [&](const std::string& constant) {
    const auto found =
        std::ranges::find(material.constants, constant, &std::pair<std::string, double>::first);
    return found == material.constants.end() ? std::nan("") : found->second;
  };
  if (name == "density" && element < 0) return Constant{"kg/m^3", "density", value(name)};
  if (material.symmetry == "isotropic" && name == "youngs_modulus" && element < 0) {
    return Constant{"Pa", "youngs_modulus", value(name)};
  }
  if (material.symmetry != "orthotropic") return std::nullopt;
  const auto in_plane = [&](const std::string& effect) {
    return Constant{"Pa", effect, value(fmt::format("{}_{}", name, element + 1))};
  };
  if (name == "youngs_modulus" && element == 0) return in_plane("stiffness_along_u");
  if (name == "youngs_modulus" && element == 1) return in_plane("stiffness_along_v");
  if (name == "shear_modulus" && element == 2) return in_plane("shear_stiffness");
  return std::nullopt;
}

double thickness_of(const Geometry& geometry) {
  if (const auto* plate = std::get_if<mesh::Plate>(&geometry.body)) return plate->thickness;
  if (const auto* disc = std::get_if<mesh::Disc>(&geometry.body)) return disc->thickness;
  if (const auto* four = std::get_if<mesh::Quadrilateral>(&geometry.body)) return four->thickness;
  return 0.0;
}

/// The constant that this key has in a plate or beam, whose length lies along x.
std::optional<Constant> of_sheet(const Study& study, const std::string& key) {
  if (key == "measurement.mass" && study.measurement) {
    return Constant{"kg", "mass", study.measurement->mass};
  }
  const auto* plate = std::get_if<mesh::Plate>(&study.geometry.body);
  if (plate == nullptr) return std::nullopt;
  if (key == fmt::format("geometry.{}.length", study.geometry.kind)) {
    return Constant{"m", "length_along_u", plate->length};
  }
  if (key == fmt::format("geometry.{}.width", study.geometry.kind)) {
    return Constant{"m", "length_along_v", plate->width};
  }
  return std::nullopt;
}

/// @param key  without the place in an array
std::optional<Constant> constant_of(const Study& study, const std::string& key, int element) {
  constexpr std::string_view kMaterial = "material.";
  if (key.starts_with(kMaterial) && study.materials.size() == 1) {
    return of_material(study.materials.front(), key.substr(kMaterial.size()), element);
  }
  if (element >= 0) return std::nullopt;
  if (key == "modes.damping_ratio")
    return Constant{"1", "modal_damping", study.modes.damping_ratio};
  if (key == fmt::format("geometry.{}.thickness", study.geometry.kind)) {
    return Constant{"m", "thickness", thickness_of(study.geometry)};
  }
  return of_sheet(study, key);
}

/// True for what is compared between specimens alone.
bool is_of_sheet(const Constant& constant) {
  return constant.effect == "mass" || constant.effect.starts_with("length_along");
}

void add_to_sheet(const KnownNumber& known, const std::string& key, const Constant& constant,
                  Study& study, Problems& problems) {
  if (known.kind == Kind::unknown) {
    problems.add(known.line, known.column,
                 key + " cannot be unknown; expected measured = \"1 %\" or within = \"1 %\"");
    return;
  }
  study.sheet.push_back(
      {key, constant.unit, constant.value, constant.effect, known.deviation, known.kind});
}

void add(const KnownNumber& known, const std::string& key, const Constant& constant, Study& study,
         Problems& problems) {
  if (!(constant.value > 0.0)) {
    if (constant.value == 0.0) {
      problems.add(known.line, known.column, key + " is 0: it has no relative deviation");
    }
    return;  // else the reader of the key has told the problem
  }
  if (is_of_sheet(constant)) {
    add_to_sheet(known, key, constant, study, problems);
    return;
  }
  study.constants.push_back(
      {key, constant.unit, constant.value, constant.effect, known.deviation, known.kind});
}

bool is_turned(const Study& study, const Constant& constant) {
  return constant.effect.find("stiffness") != std::string::npos &&
         study.materials.front().is_turned;
}

}  // namespace

std::vector<KnownNumber> without_statements(TomlNode& tree, Problems& problems) {
  Taker taker(problems);
  taker.walk(tree, "");
  return taker.taken();
}

std::vector<std::string> keys_with_deviations() {
  return {"material.density",
          "material.youngs_modulus (orthotropic: [0] and [1])",
          "material.shear_modulus[2]",
          "modes.damping_ratio",
          "thickness of a plate, beam, disc or quadrilateral",
          "of specimens also length and width of a plate or beam, and measurement.mass"};
}

namespace {

/// False: no number of the key is a constant that can be calibrated.
bool read_one(const KnownNumber& known, Study& study, Problems& problems) {
  const std::string base =
      known.element < 0 ? known.key : known.key.substr(0, known.key.rfind('['));
  const int first = known.of_array ? 0 : known.element;
  const int last = known.of_array ? 2 : known.element;
  bool any = false;
  for (int element = first; element <= last; ++element) {
    const auto constant = constant_of(study, base, element);
    if (!constant) continue;
    any = true;
    if (is_turned(study, *constant)) {
      problems.add(known.line, known.column,
                   base + " cannot be calibrated where the material has an angle or axes");
      return true;
    }
    const auto key = known.of_array ? fmt::format("{}[{}]", base, element) : known.key;
    add(known, key, *constant, study, problems);
  }
  return any;
}

}  // namespace

void read_known(const std::vector<KnownNumber>& numbers, Study& study, Problems& problems) {
  for (const auto& known : numbers) {
    if (read_one(known, study, problems)) continue;
    problems.add(known.line, known.column,
                 fmt::format("{} states how well it is known, but cannot be calibrated; of a study "
                             "with one material these can: {}",
                             known.key, fmt::join(keys_with_deviations(), ", ")));
  }
}

}  // namespace chladni::study
