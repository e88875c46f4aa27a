// Rows of a schema that several tables have: needed quantities, bands, words, names, faces and
// directions.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/schema.h"
#include "study/tables/tables.h"

namespace chladni::study {

/// A quantity that must be given.
template <typename Plan>
Key<Plan> needed(const std::string& name, const std::string& si_unit, double Plan::*value,
                 const std::string& meaning) {
  auto key = quantity(name, si_unit, Sign::positive, value, meaning, "needed");
  key.read = [=](TableReader& table, Plan& plan) {
    plan.*value = table.required_quantity(name, si_unit, Sign::positive);
  };
  return key;
}

/// Two frequencies, the second above the first. A wrong value is a problem, and `example` is part
/// of its message.
void read_band(TableReader& table, const std::string& name, const std::string& example,
               double& low_hz, double& high_hz);

template <typename Plan>
Key<Plan> band(const std::string& name, double Plan::*low, double Plan::*high,
               const std::string& example, const std::string& meaning,
               const std::string& otherwise) {
  return {.text = {name, "two quantities in Hz, ascending", otherwise, meaning},
          .json_name = json_name(name, "Hz"),
          .read = [=](TableReader& table,
                      Plan& plan) { read_band(table, name, example, plan.*low, plan.*high); },
          .json =
              [=](const Plan& plan) {
                return io::JsonArray{plan.*low, plan.*high};
              }};
}

/// One of two words; `yes` is the one for true.
template <typename Plan>
Key<Plan> either(const std::string& name, const std::vector<std::string>& words,
                 const std::string& yes, bool Plan::*value, const std::string& meaning) {
  const std::string no = words.at(words.front() == yes ? 1 : 0);
  return {.text = {name, quoted(words), quoted({Plan{}.*value ? yes : no}), meaning},
          .json_name = name,
          .read =
              [=](TableReader& table, Plan& plan) {
                if (const auto word = table.choice(name, words)) plan.*value = *word == yes;
              },
          .json = [=](const Plan& plan) { return io::Json(plan.*value ? yes : no); }};
}

/// Names out of a list.
/// @param what  one of them in messages: "method"
template <typename Plan>
Key<Plan> names(KeyText text, const std::string& what,
                const std::function<std::vector<std::string>()>& known,
                std::vector<std::string> Plan::*value) {
  const std::string name = text.name;
  return {.text = std::move(text),
          .json_name = name,
          .read =
              [=](TableReader& table, Plan& plan) {
                plan.*value = table.texts(name);
                refuse_strangers(table, name, what, plan.*value, known());
              },
          .json = [=](const Plan& plan) { return io::Json::texts(plan.*value); }};
}

/// "on": the faces that a table is about.
template <typename Plan>
Key<Plan> faces(const std::string& meaning) {
  return {.text = {"on", "names of patches, or { facing = \"z\" }", "what looks up", meaning},
          .json_name = "on",
          .read = [](TableReader& table, Plan& plan) { plan.on = read_faces(table, "on"); },
          .json = [](const Plan& plan) { return faces_json(plan.on); }};
}

/// "direction": that of the motion there.
template <typename Plan>
Key<Plan> motion(const std::string& meaning) {
  return {.text = {"direction", R"("x", "-z", three numbers, or "normal")", "that of the faces",
                   meaning},
          .json_name = "direction",
          .read = [](TableReader& table,
                     Plan& plan) { read_motion(table, plan.direction, plan.along_normal); },
          .json = [](const Plan& plan) { return motion_json(plan.direction); }};
}

/// "uff": the dataset of mode shapes in a universal file.
template <typename Plan>
Key<Plan> shape_dataset(const std::string& file) {
  return choice("uff", {"none", "55", "2414"}, &Plan::uff, "dataset of the shapes in " + file);
}

/// For a key that study.json has nothing of, or shows elsewhere.
template <typename Plan>
std::optional<io::Json> not_shown(const Plan& /*plan*/) {
  return std::nullopt;
}

/// What the keys of a schema say of a part.
template <typename Part>
Part read_part(TableReader& table, const Schema<Part>& schema) {
  Part part;
  schema.read(table, part);
  return part;
}

/// The names of the members of a list of the program: its effects, criteria, kernels.
template <typename List>
std::vector<std::string> names_in(const List& list) {
  std::vector<std::string> names;
  for (const auto* one : list) names.emplace_back(one->name);
  return names;
}

}  // namespace chladni::study
