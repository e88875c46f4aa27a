// The keys of the tables that have a schema: one place for reader, study.json and page.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

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
      EXPECT_TRUE(names.insert(key.name).second) << table.table << "." << key.name;
      EXPECT_FALSE(key.meaning.empty() || key.expected.empty() || key.otherwise.empty())
          << table.table << "." << key.name;
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

TEST(Schema, LeavesADefaultPlanWhereATableIsEmpty) {
  const auto study = with("[identification]\n[mesh]\n[modes]\n[diagnosis]\ntolerances = {}\n");
  EXPECT_EQ(io::text(io::Json(identification_schema().json(*study.identification))),
            io::text(io::Json(identification_schema().json(IdentificationPlan{}))));
  EXPECT_EQ(io::text(io::Json(mesh_schema().json(study.mesh))),
            io::text(io::Json(mesh_schema().json(MeshPlan{}))));
  EXPECT_EQ(io::text(io::Json(modes_schema().json(study.modes))),
            io::text(io::Json(modes_schema().json(ModesPlan{}))));
  EXPECT_EQ(io::text(io::Json(tolerances_schema().json(study.diagnosis->tolerances))),
            io::text(io::Json(tolerances_schema().json(diagnosis::Tolerances{}))));
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
