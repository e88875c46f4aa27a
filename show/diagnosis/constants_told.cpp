#include "show/diagnosis/constants_told.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "show/readable.h"

namespace chladni::show {
namespace {

using diagnosis::CalibratedNumber;

std::string value(const CalibratedNumber& one, double number) {
  const auto [scale, unit] = readable_constant(one.unit, one.of_study);
  return fmt::format("{:.4g}{}{}", scale * number, unit.empty() ? "" : " ", unit);
}

std::string value_and_std(const CalibratedNumber& one) {
  const auto [scale, unit] = readable_constant(one.unit, one.of_study);
  return fmt::format("{:.4g} \u00b1 {}{}{}", scale * one.value, deviation_text(scale * one.std),
                     unit.empty() ? "" : " ", unit);
}

// "+12.1 %", or that the data do not say.
std::string change(const CalibratedNumber& one) {
  return one.determined ? fmt::format("{:+.1f} %", 100.0 * one.change()) : "not determined";
}

// How far from the study, in what was stated of it.
double in_deviations(const CalibratedNumber& one) {
  return std::log(one.value / one.of_study) / one.prior;
}

}  // namespace

std::string constants_text(const diagnosis::Diagnosis& result) {
  std::string text;
  for (const auto& one : result.constants) {
    text += fmt::format("  {}: {} (study: {} within {:.2g} %, {})\n", one.name, value_and_std(one),
                        value(one, one.of_study), 100.0 * one.prior, change(one));
  }
  for (const auto& pair : result.constants_in_pairs) {
    text +=
        fmt::format("  correlation of {} and {}: {:.2f}\n", pair.one, pair.other, pair.correlation);
  }
  return text.empty() ? text : "calibrated:\n" + text;
}

io::JsonObject constant_json(const CalibratedNumber& number) {
  return {{"key", number.name},
          {"unit", number.unit},
          {"of_study", number.of_study},
          {"value", number.value},
          {"std", number.std},
          {"prior", number.prior},
          {"determined", number.determined}};
}

io::JsonArray constants_json(const diagnosis::Diagnosis& result) {
  io::JsonArray array;
  for (const auto& one : result.constants) {
    io::JsonObject together;
    for (const auto& pair : result.constants_in_pairs) {
      if (pair.one == one.name) together.emplace_back(pair.other, pair.correlation);
      if (pair.other == one.name) together.emplace_back(pair.one, pair.correlation);
    }
    auto json = constant_json(one);
    json.emplace_back("correlations", together);
    array.emplace_back(std::move(json));
  }
  return array;
}

io::Table constants_table(const diagnosis::Diagnosis& result) {
  io::Table table{"Calibrated constants",
                  {{"constant"}, {"study"}, {"calibrated"}, {"change"}, {"in stated deviations"}},
                  {}};
  for (const auto& one : result.constants) {
    table.rows.push_back({{one.name, value(one, one.of_study), value_and_std(one), change(one),
                           fmt::format("{:+.1f}", in_deviations(one))}});
  }
  return table;
}

}  // namespace chladni::show
