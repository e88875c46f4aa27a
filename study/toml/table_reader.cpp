#include "study/toml/table_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/quantity.h"

namespace chladni::study {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Meaning of a unit, with an example.
std::string example_of(std::string_view si_unit) {
  constexpr std::pair<std::string_view, std::string_view> kExamples[] = {
      {"m", "a length such as \"20 mm\""},
      {"Pa", "a pressure such as \"70 GPa\""},
      {"kg/m^3", "a density such as \"2700 kg/m^3\""},
      {"kg", "a mass such as \"150 g\""},
      {"kg m^2", "an inertia such as \"2e-5 kg m^2\""},
      {"N/m", "a stiffness such as \"1200 N/m\""},
      {"N m/rad", "a torsional stiffness such as \"0.5 N m/rad\""},
      {"N s/m", "a damping such as \"0.2 N s/m\""},
      {"N m s/rad", "a torsional damping such as \"1e-3 N m s/rad\""},
      {"Hz", "a frequency such as \"500 Hz\""},
      {"s", "a time such as \"12 us\""},
      {"rad", "an angle such as \"45 deg\""},
      {"m^3", "a volume such as \"7200 cm^3\""},
      {"1", "a number such as 0.005"}};
  for (const auto& [unit, example] : kExamples) {
    if (unit == si_unit) return std::string(example);
  }
  return "a quantity in " + std::string(si_unit);
}

std::string sign_text(Sign sign) { return sign == Sign::positive ? "more than 0" : "0 or more"; }

}  // namespace

TableReader::TableReader(const TomlNode& table, std::string path, Problems& problems,
                         std::string whole)
    : table_(table), path_(std::move(path)), problems_(&problems), whole_(std::move(whole)) {}

std::string TableReader::name(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

bool TableReader::has(std::string_view key) const {
  return std::any_of(table_.members.begin(), table_.members.end(),
                     [&](const TomlMember& m) { return m.key == key; });
}

const TomlNode* TableReader::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  for (const auto& member : table_.members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

void TableReader::wrong(const TomlNode& where, const std::string& message) {
  problems_->add(where.line, where.column, message);
}

void TableReader::missing(std::string_view key, std::string_view expected) {
  wrong(table_, (path_.empty() ? whole_ : path_) + " lacks \"" + std::string(key) +
                    "\"; expected " + std::string(expected));
}

double TableReader::value_of(const TomlNode& node, const std::string& what,
                             std::string_view si_unit, Sign sign) {
  double value = kNone;
  if (node.kind == TomlNode::Kind::text) {
    try {
      value = chladni::quantity(node.text, si_unit);
    } catch (const InvalidInput& e) {
      wrong(node, what + ": " + e.what());
      return kNone;
    }
  } else if (node.is_number() && si_unit == "1") {
    value = node.number;
  } else if (node.is_number()) {
    wrong(node, what + " = " + node.text + " has no unit; expected " + example_of(si_unit));
    return kNone;
  } else {
    wrong(node, what + " is " + description(node) + "; expected " + example_of(si_unit));
    return kNone;
  }
  if (!std::isfinite(value)) {
    wrong(node, what + " is " + node.text + "; expected a finite value, " + example_of(si_unit));
    return kNone;
  }
  const bool good =
      sign == Sign::any || value > 0.0 || (sign == Sign::not_negative && value == 0.0);
  if (!good) {
    wrong(node, what + " is " + node.text + "; expected " + sign_text(sign));
    return kNone;
  }
  return value;
}

std::optional<double> TableReader::quantity(std::string_view key, std::string_view si_unit,
                                            Sign sign) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const double value = value_of(*node, name(key), si_unit, sign);
  if (std::isnan(value)) return std::nullopt;
  return value;
}

double TableReader::required_quantity(std::string_view key, std::string_view si_unit, Sign sign) {
  if (find(key) == nullptr) {
    missing(key, example_of(si_unit));
    return kNone;
  }
  return quantity(key, si_unit, sign).value_or(kNone);
}

std::optional<Eigen::VectorXd> TableReader::quantities(std::string_view key,
                                                       std::string_view si_unit, Eigen::Index count,
                                                       Sign sign) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind != TomlNode::Kind::array ||
      static_cast<Eigen::Index>(node->elements.size()) != count) {
    wrong(*node, name(key) + " is " + description(*node) + "; expected an array of " +
                     fmt::to_string(count) + ", each " + example_of(si_unit));
    return std::nullopt;
  }
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    values(i) = value_of(node->elements[static_cast<std::size_t>(i)],
                         name(key) + "[" + fmt::to_string(i) + "]", si_unit, sign);
  }
  if (values.hasNaN()) return std::nullopt;
  return values;
}

std::optional<long long> TableReader::integer(std::string_view key, long long least,
                                              long long most) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const bool whole = node->kind == TomlNode::Kind::integer;
  if (whole && node->number >= static_cast<double>(least) &&
      node->number <= static_cast<double>(most)) {
    return static_cast<long long>(node->number);
  }
  wrong(*node, name(key) + " is " + description(*node) + "; expected a whole number from " +
                   fmt::to_string(least) + " to " + fmt::to_string(most));
  return std::nullopt;
}

std::optional<std::string> TableReader::text(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind == TomlNode::Kind::text && !node->text.empty()) return node->text;
  wrong(*node, name(key) + " is " + description(*node) + "; expected a text that is not empty");
  return std::nullopt;
}

std::string TableReader::required_text(std::string_view key) {
  if (find(key) == nullptr) missing(key, "a text");
  return text(key).value_or("");
}

std::optional<std::string> TableReader::choice(std::string_view key,
                                               const std::vector<std::string>& names) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind == TomlNode::Kind::text &&
      std::find(names.begin(), names.end(), node->text) != names.end()) {
    return node->text;
  }
  const std::string near =
      node->kind == TomlNode::Kind::text ? nearest_name(node->text, names) : std::string();
  wrong(*node, name(key) + " is " + description(*node) + "; expected " + listed(names) +
                   (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  return std::nullopt;
}

std::optional<bool> TableReader::truth(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind == TomlNode::Kind::truth) return node->truth;
  wrong(*node, name(key) + " is " + description(*node) + "; expected true or false");
  return std::nullopt;
}

std::vector<std::string> TableReader::texts(std::string_view key) {
  const TomlNode* node = find(key);
  std::vector<std::string> out;
  if (node == nullptr) return out;
  if (node->kind != TomlNode::Kind::array) {
    wrong(*node, name(key) + " is " + description(*node) + "; expected an array of texts");
    return out;
  }
  for (const auto& element : node->elements) {
    if (element.kind == TomlNode::Kind::text) {
      out.push_back(element.text);
    } else {
      wrong(element, name(key) + " holds " + description(element) + "; expected a text");
    }
  }
  return out;
}

std::optional<TableReader> TableReader::table(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind == TomlNode::Kind::table) return TableReader(*node, name(key), *problems_);
  wrong(*node, name(key) + " is " + description(*node) + "; expected a table { ... }");
  return std::nullopt;
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  const TomlNode* node = find(key);
  std::vector<TableReader> out;
  if (node == nullptr) return out;
  if (node->kind != TomlNode::Kind::array) {
    wrong(*node, name(key) + " is " + description(*node) + "; expected tables, each headed by [[" +
                     name(key) + "]]");
    return out;
  }
  for (std::size_t i = 0; i < node->elements.size(); ++i) {
    const auto& element = node->elements[i];
    const std::string path = name(key) + "[" + fmt::to_string(i) + "]";
    if (element.kind == TomlNode::Kind::table) {
      out.emplace_back(element, path, *problems_);
    } else {
      wrong(element, path + " is " + description(element) + "; expected a table");
    }
  }
  return out;
}

std::optional<Eigen::Vector3d> TableReader::direction(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const std::string expected =
      "; expected \"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or three numbers that are not all 0";
  if (node->kind == TomlNode::Kind::text) {
    const bool minus = node->text.starts_with('-');
    const std::string axis = node->text.substr(minus || node->text.starts_with('+') ? 1 : 0);
    if (axis == "x" || axis == "y" || axis == "z") {
      return (minus ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis[0] - 'x');
    }
  }
  if (node->kind == TomlNode::Kind::array && node->elements.size() == 3) {
    Eigen::Vector3d vector;
    for (std::size_t i = 0; i < 3; ++i) {
      vector(static_cast<Eigen::Index>(i)) =
          node->elements[i].is_number() ? node->elements[i].number : kNone;
    }
    if (vector.allFinite() && vector.norm() > 0.0) return vector.stableNormalized();
  }
  wrong(*node, name(key) + " is " + description(*node) + expected);
  return std::nullopt;
}

void TableReader::refuse_unknown() {
  for (const auto& member : table_.members) {
    if (std::find(known_.begin(), known_.end(), member.key) != known_.end()) continue;
    const std::string near = nearest_name(member.key, known_);
    problems_->add(
        member.line, member.column,
        "unknown key \"" + member.key + "\" in " + (path_.empty() ? whole_ : path_) +
            (near.empty() ? "; known are " + listed(known_) : "; did you mean \"" + near + "\"?"));
  }
}

}  // namespace chladni::study
