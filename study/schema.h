// The keys of a table of a study: each stands once, with its unit, default, bounds and meaning. The
// reader, study.json, the page of keys and `chladni list keys` follow from it.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/json.h"
#include "study/toml/table_reader.h"

namespace chladni::study {

/// One key, without the type of its plan.
struct KeyText {
  std::string name;       ///< in the file
  std::string expected;   ///< "a quantity in m, positive", "1 to 1000", "\"all\" or \"odd\""
  std::string otherwise;  ///< the value without this key, as in the file: "40", "found"
  std::string meaning;    ///< a part of a sentence
};

/// One key of the table that fills a `Plan`.
template <typename Plan>
struct Key {
  KeyText text;
  std::string json_name;                          ///< with its unit: "band_hz"
  std::function<void(TableReader&, Plan&)> read;  ///< empty: a reader of its own does it
  std::function<std::optional<io::Json>(const Plan& plan)> json;  ///< in SI; none: not shown
};

template <typename Plan>
struct Schema {
  std::string table;  ///< "identification"
  std::vector<Key<Plan>> keys;

  /// Reads every key that has no reader of its own. Problems are the table's.
  void read(TableReader& reader, Plan& plan) const {
    for (const auto& key : keys) {
      if (key.read) key.read(reader, plan);
    }
  }
  /// The plan as study.json shows it: in SI, in the order of the keys.
  [[nodiscard]] io::JsonObject json(const Plan& plan) const {
    io::JsonObject object;
    for (const auto& key : keys) {
      if (auto value = key.json(plan)) object.emplace_back(key.json_name, std::move(*value));
    }
    return object;
  }
};

/// "band_hz", "delay_s": the name of a quantity in JSON.
[[nodiscard]] std::string json_name(const std::string& name, const std::string& si_unit);
/// "a quantity in Hz, positive"
[[nodiscard]] std::string expected_quantity(const std::string& si_unit, Sign sign);
/// "\"all\", \"odd\""
[[nodiscard]] std::string quoted(const std::vector<std::string>& names);
/// "40" and, in words of its own, what it stands for.
[[nodiscard]] std::string default_text(double value, const std::string& si_unit);

/// A quantity that is stored in SI.
/// @param otherwise  in words, where the default is no number of its own ("found"); else empty
template <typename Plan>
Key<Plan> quantity(const std::string& name, const std::string& si_unit, Sign sign,
                   double Plan::*value, const std::string& meaning,
                   const std::string& otherwise = "") {
  return {.text = {name, expected_quantity(si_unit, sign),
                   otherwise.empty() ? default_text(Plan{}.*value, si_unit) : otherwise, meaning},
          .json_name = json_name(name, si_unit),
          .read =
              [=](TableReader& table, Plan& plan) {
                plan.*value = table.quantity(name, si_unit, sign).value_or(plan.*value);
              },
          .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

/// A quantity that may stay unknown; null in JSON.
template <typename Plan>
Key<Plan> quantity(const std::string& name, const std::string& si_unit, Sign sign,
                   std::optional<double> Plan::*value, const std::string& meaning,
                   const std::string& otherwise) {
  return {
      .text = {name, expected_quantity(si_unit, sign), otherwise, meaning},
      .json_name = json_name(name, si_unit),
      .read = [=](TableReader& table,
                  Plan& plan) { plan.*value = table.quantity(name, si_unit, sign); },
      .json =
          [=](const Plan& plan) { return plan.*value ? io::Json(*(plan.*value)) : io::Json(); }};
}

/// A whole number from `least` to `most`.
template <typename Plan>
Key<Plan> whole(const std::string& name, int least, int most, int Plan::*value,
                const std::string& meaning, const std::string& otherwise = "") {
  return {.text = {name, fmt::format("{} to {}", least, most),
                   otherwise.empty() ? fmt::to_string(Plan{}.*value) : otherwise, meaning},
          .json_name = name,
          .read =
              [=](TableReader& table, Plan& plan) {
                plan.*value =
                    static_cast<int>(table.integer(name, least, most).value_or(plan.*value));
              },
          .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

/// One of some words.
template <typename Plan>
Key<Plan> choice(const std::string& name, const std::vector<std::string>& words,
                 std::string Plan::*value, const std::string& meaning,
                 const std::string& otherwise = "") {
  return {
      .text = {name, quoted(words), otherwise.empty() ? quoted({Plan{}.*value}) : otherwise,
               meaning},
      .json_name = name,
      .read = [=](TableReader& table,
                  Plan& plan) { plan.*value = table.choice(name, words).value_or(plan.*value); },
      .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

template <typename Plan>
Key<Plan> truth(const std::string& name, bool Plan::*value, const std::string& meaning) {
  return {.text = {name, "true or false", Plan{}.*value ? "true" : "false", meaning},
          .json_name = name,
          .read = [=](TableReader& table,
                      Plan& plan) { plan.*value = table.truth(name).value_or(plan.*value); },
          .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

template <typename Plan>
Key<Plan> text(const std::string& name, std::string Plan::*value, const std::string& meaning,
               const std::string& otherwise) {
  return {.text = {name, "a text", otherwise, meaning},
          .json_name = name,
          .read = [=](TableReader& table,
                      Plan& plan) { plan.*value = table.text(name).value_or(plan.*value); },
          .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

/// A key with a reader of its own: what it may be depends on other keys or parts of the study.
template <typename Plan>
Key<Plan> special(KeyText text, std::string name_in_json,
                  std::function<std::optional<io::Json>(const Plan& plan)> json) {
  return {.text = std::move(text),
          .json_name = std::move(name_in_json),
          .read = {},
          .json = std::move(json)};
}

}  // namespace chladni::study
