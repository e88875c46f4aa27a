// [expect] of a study: its keys, their reader and study.json.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

/// A result that a study may expect.
struct ExpectedResult {
  std::string_view name, unit, meaning;
  bool numbered;  ///< followed by _1, _2, ...
};
constexpr std::array<ExpectedResult, 4> kExpectedResults = {
    {{"frequency", "Hz", "of the first flexible mode; `frequency_2`, ... of those above it", true},
     {"rigid_body_modes", "1", "their number", false},
     {"mass", "kg", "with point masses and resonators", false},
     {"volume", "m^3", "of the body", false}}};

/// The key for people: "frequency_1", "mass".
std::string key_of(const ExpectedResult& result) {
  return std::string(result.name) + (result.numbered ? "_1" : "");
}

const ExpectedResult* expected_result(const std::string& key) {
  for (const auto& result : kExpectedResults) {
    if (!result.numbered && key == result.name) return &result;
    if (!result.numbered || !key.starts_with(std::string(result.name) + "_")) continue;
    const char* first = key.data() + result.name.size() + 1;
    const char* last = key.data() + key.size();
    int number = 0;
    const auto [end, fault] = std::from_chars(first, last, number);
    if (fault == std::errc() && end == last && number >= 1 && number <= kMostModes) return &result;
  }
  return nullptr;
}

/// "1 %" of the value, or a width in the value's own unit.
double width_of(TableReader& table, const TomlNode& node, double value, std::string_view unit) {
  const bool relative = node.is_number() || node.text.find('%') != std::string::npos;
  if (!relative) return table.value_of(node, table.name("within"), unit, Sign::not_negative);
  return std::abs(value) * table.value_of(node, table.name("within"), "1", Sign::not_negative);
}

Expectation expectation_of(TableReader& table, const std::string& key,
                           const ExpectedResult& result) {
  Expectation expectation;
  expectation.key = key;
  expectation.unit = result.unit;
  expectation.line = table.line();
  expectation.value = table.required_quantity("value", result.unit);
  if (const TomlNode* within = table.find("within")) {
    expectation.within = width_of(table, *within, expectation.value, result.unit);
    expectation.as_written =
        table.find("value") == nullptr ? "" : table.find("value")->text + " within " + within->text;
  } else if (result.unit == "1") {
    expectation.as_written = "exactly";
  } else {
    table.missing("within", "\"1 %\" or a width such as \"0.5 Hz\"");
  }
  table.refuse_unknown();
  return expectation;
}

}  // namespace

TableText expected_keys() {
  TableText text{"`[expect]`", {}};
  for (const auto& result : kExpectedResults) {
    const std::string form =
        result.unit == "1"
            ? "{ value } a number"
            : fmt::format("{{ value, within }} in {}; within also a share", result.unit);
    text.keys.push_back({key_of(result), form, "not compared", std::string(result.meaning)});
  }
  return text;
}

io::Json expectations_json(const std::vector<Expectation>& expectations) {
  io::JsonObject object;
  for (const auto& expectation : expectations) {
    object.emplace_back(expectation.key, io::JsonObject{{"value", expectation.value},
                                                        {"within", expectation.within},
                                                        {"unit", expectation.unit}});
  }
  return object;
}

void read_expectations(TableReader& root, Study& study) {
  auto table = root.table("expect");
  if (!table) return;
  for (const auto& member : root.find("expect")->members) {
    const auto* result = expected_result(member.key);
    if (result == nullptr) continue;
    if (auto own = table->table(member.key)) {
      study.expectations.push_back(expectation_of(*own, member.key, *result));
    }
  }
  for (const auto& result : kExpectedResults) {
    table->find(key_of(result));  // makes the key known: a misspelt one gets its nearest name
  }
  table->refuse_unknown();
}

}  // namespace chladni::study
