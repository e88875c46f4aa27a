// The keys of the tables that have a schema: one place for reader, study.json and page.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "base/error.h"
#include "study/schemas.h"

namespace chladni::study {
namespace {

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(std::string(CHLADNI_SOURCE_DIR) + "/" + file).rdbuf();
  return text.str();
}

TEST(Schema, IsThePageOfKeys) {
  EXPECT_EQ(text_of("docs/reference/keys.md"), page_of_keys())
      << "chladni list keys > docs/reference/keys.md";
}

TEST(Schema, NamesEachKeyOnceWithItsMeaning) {
  for (const auto& table : tables_with_schemas()) {
    std::set<std::string> names;
    for (const auto& key : table.keys) {
      EXPECT_TRUE(names.insert(key.name).second) << table.heading << "." << key.name;
      EXPECT_FALSE(key.meaning.empty() || key.expected.empty() || key.otherwise.empty())
          << table.heading << "." << key.name;
    }
  }
}

Study with(const std::string& table) {
  return parse_study(R"(
[geometry]
plate = { length = "400 mm", width = "300 mm", thickness = "12 mm" }
[material]
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
density = "2700 kg/m^3"
)" + table,
                     "plate.toml");
}

template <typename Plan>
void expect_default(const Schema<Plan>& schema, const Plan& plan) {
  EXPECT_EQ(io::text(io::Json(schema.json(plan))), io::text(io::Json(schema.json(Plan{}))))
      << schema.table;
}

TEST(Schema, LeavesADefaultPlanWhereATableIsEmpty) {
  const auto study = with(
      "[identification]\n[mesh]\n[modes]\n[placement]\nchoose = "
      "{}\n[interpolation]\n[priors]\n[diagnosis]\n"
      "tolerances = {}\ncosts = {}\n");
  expect_default(identification_schema(), *study.identification);
  expect_default(mesh_schema(), study.mesh);
  expect_default(modes_schema(), study.modes);
  expect_default(placement_schema(), *study.placement);
  expect_default(interpolation_schema(), *study.interpolation);
  expect_default(priors_schema(), *study.priors);
  expect_default(diagnosis_schema(), *study.diagnosis);
  expect_default(tolerances_schema(), study.diagnosis->tolerances);
  expect_default(costs_schema(), study.diagnosis->costs);
}

TEST(Schema, LeavesTheOtherKeysOfAMeasurementByDefault) {
  MeasurementPlan plan;
  plan.frf = "measured.csv";
  const auto study = with("[measurement]\nfrf = \"measured.csv\"\n");
  EXPECT_EQ(io::text(io::Json(measurement_schema().json(*study.measurement))),
            io::text(io::Json(measurement_schema().json(plan))));
}

/// "[[attachment]]" and a line that says the kind, from "`[[attachment]]` of kind `mass`".
std::string head_of(const std::string& heading) {
  const auto end = heading.find('`', 1);
  const auto head = heading.substr(1, end - 1) + "\n";
  const auto kind = heading.find("of kind `");
  if (kind == std::string::npos) return head;
  const auto word = heading.substr(kind + 9);
  return head + "kind = \"" + word.substr(0, word.size() - 1) + "\"\n";
}

/// Whether the reader of a table refuses a key of that name; whatever it says of the value.
bool refuses(const std::string& head, const std::string& key) {
  try {
    static_cast<void>(with(head + key + " = 0\n"));
  } catch (const InvalidInput& e) {
    return std::string(e.what()).find("unknown key") != std::string::npos;
  }
  return false;
}

TEST(Schema, NamesKeysThatTheReaderKnows) {
  for (const auto& table : tables_with_schemas()) {
    if (table.heading.starts_with("`[geometry") || table.heading.starts_with("`[[geometry") ||
        table.heading.starts_with("`[material")) {
      continue;  // a study has one of each already
    }
    const auto head = head_of(table.heading);
    for (const auto& key : table.keys) EXPECT_FALSE(refuses(head, key.name)) << head << key.name;
    EXPECT_TRUE(head == "[[attachment]]\n" || refuses(head, "no_such_key")) << head;
  }
}

TEST(Schema, ReadsEachToleranceIntoItsOwnNumber) {
  double value = 0.0;
  std::string table = "[diagnosis.tolerances]\n";
  for (const auto& key : tolerances_schema().keys) {
    value += 1e-3;
    const auto unit = key.json_name.substr(key.text.name.size());
    table +=
        fmt::format("{} = \"{} {}\"\n", key.text.name, value, unit.empty() ? "" : unit.substr(1));
  }
  const auto found = tolerances_schema().json(with(table).diagnosis->tolerances);
  value = 0.0;
  for (const auto& [name, json] : found) {
    value += 1e-3;
    EXPECT_DOUBLE_EQ(json.number(), value) << name;
  }
}

}  // namespace
}  // namespace chladni::study
