// Modes, layouts, measurement and expectations of a study.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

struct ExpectedKey {
  std::string_view key, unit;
  bool numbered;  ///< followed by _1, _2, ...
};
constexpr std::array<ExpectedKey, 4> kExpected = {{{"frequency", "Hz", true},
                                                   {"rigid_body_modes", "1", false},
                                                   {"mass", "kg", false},
                                                   {"volume", "m^3", false}}};

const ExpectedKey* expected_key(const std::string& key) {
  for (const auto& known : kExpected) {
    if (!known.numbered && key == known.key) return &known;
    if (!known.numbered || !key.starts_with(std::string(known.key) + "_")) continue;
    const char* first = key.data() + known.key.size() + 1;
    const char* last = key.data() + key.size();
    int number = 0;
    const auto [end, fault] = std::from_chars(first, last, number);
    if (fault == std::errc() && end == last && number >= 1 && number <= kMostModes) return &known;
  }
  return nullptr;
}

/// "1 %" of the value, or a width in the value's own unit.
double width_of(TableReader& table, const TomlNode& node, double value, std::string_view unit) {
  const bool relative = node.is_number() || node.text.find('%') != std::string::npos;
  if (!relative) return table.value_of(node, table.name("within"), unit, Sign::not_negative);
  return std::abs(value) * table.value_of(node, table.name("within"), "1", Sign::not_negative);
}

void read_expectation(TableReader& table, const std::string& key, const ExpectedKey& known,
                      Study& study) {
  Expectation expectation;
  expectation.key = key;
  expectation.unit = known.unit;
  expectation.line = table.line();
  expectation.value = table.required_quantity("value", known.unit);
  if (const TomlNode* within = table.find("within")) {
    expectation.within = width_of(table, *within, expectation.value, known.unit);
    expectation.as_written =
        table.find("value") == nullptr ? "" : table.find("value")->text + " within " + within->text;
  } else if (known.unit == "1") {
    expectation.as_written = "exactly";
  } else {
    table.missing("within", "\"1 %\" or a width such as \"0.5 Hz\"");
  }
  table.refuse_unknown();
  study.expectations.push_back(expectation);
}

}  // namespace

std::vector<std::string> names_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const auto& channel : channels) names.push_back(channel.name);
  return names;
}

std::vector<std::string> channel_names(const Study& study) {
  auto names = names_of(study.sensors);
  const auto actuators = names_of(study.actuators);
  names.insert(names.end(), actuators.begin(), actuators.end());
  return names;
}

void refuse_strangers(TableReader& table, std::string_view key, const std::string& what,
                      const std::vector<std::string>& wanted,
                      const std::vector<std::string>& known) {
  const TomlNode* node = table.find(key);
  if (node == nullptr) return;  // the one who needs it has said so
  for (const auto& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    table.wrong(*node, table.name(key) + " names \"" + name + "\", but no " + what +
                           " has that name" +
                           (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }
}

void read_modes_part(TableReader& root, Study& study) {
  auto table = root.table("modes");
  if (!table) return;
  modes_schema().read(*table, study.modes);
  if (table->has("count") && table->has("up_to")) {
    table->wrong(*table->find("up_to"), "modes has count and up_to; expected one of them");
  }
  if (study.modes.damping_ratio >= 1.0) {
    table->wrong(*table->find("damping_ratio"),
                 "modes.damping_ratio must be below 1 (a fraction of critical; 0.5 % is 0.005)");
  }
  table->refuse_unknown();
}

void read_layouts(TableReader& root, Study& study) {
  Names names("layout");
  for (auto& table : root.tables("layout")) {
    LayoutPlan layout;
    layout.name = table.required_text("name");
    names.add(table, layout.name);
    layout.sensors = table.texts("sensors");
    layout.actuators = table.texts("actuators");
    refuse_strangers(table, "sensors", "sensor of the study", layout.sensors,
                     names_of(study.sensors));
    refuse_strangers(table, "actuators", "actuator of the study", layout.actuators,
                     names_of(study.actuators));
    table.refuse_unknown();
    study.layouts.push_back(layout);
  }
}

void read_expectations(TableReader& root, Study& study) {
  auto table = root.table("expect");
  if (!table) return;
  for (const auto& member : root.find("expect")->members) {
    const auto* known = expected_key(member.key);
    if (known == nullptr) continue;
    if (auto one = table->table(member.key)) read_expectation(*one, member.key, *known, study);
  }
  for (const auto* name : {"frequency_1", "rigid_body_modes", "mass", "volume"}) {
    table->find(name);  // makes the key known, so that a misspelt key gets its nearest name
  }
  table->refuse_unknown();
}

}  // namespace chladni::study
