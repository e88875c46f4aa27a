// The keys of the tables that have a schema: one place for reader, study.json and page.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "study/schemas.h"
#include "tests/refusal.h"
#include "tests/study/plate_text.h"

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

// A bar in a cell would begin another one.
TEST(Schema, RowsOfThePageHaveFourCells) {
  std::istringstream page(page_of_keys());
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| ")) continue;
    int bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    }
    EXPECT_EQ(bars, 5) << line;
  }
}

TEST(Schema, NamesEachKeyOnceWithItsMeaning) {
  for (const auto& table : tables_of_a_study()) {
    std::set<std::string> names;
    for (const auto& key : table.keys) {
      EXPECT_TRUE(names.insert(key.name).second) << table.heading << "." << key.name;
      EXPECT_FALSE(key.meaning.empty() || key.expected.empty() || key.otherwise.empty())
          << table.heading << "." << key.name;
    }
  }
}

/// @param top  what stands above all tables
Study with(const std::string& table, const std::string& top = "") {
  return parse_study(top + kPlateText + table, "plate.toml");
}

template <typename Plan>
void expect_default(const Schema<Plan>& schema, const Plan& plan) {
  EXPECT_EQ(io::text(io::Json(schema.json(plan))), io::text(io::Json(schema.json(Plan{}))))
      << schema.table;
}

TEST(Schema, LeavesADefaultPlanWhereATableIsEmpty) {
  const auto study = with(
      "[identification]\n[state_space]\n[mesh]\n[modes]\n[placement]\nchoose = "
      "{}\n[interpolation]\n[priors]\n[diagnosis]\n"
      "tolerances = {}\ncosts = {}\n");
  expect_default(identification_schema(), *study.identification);
  expect_default(state_space_schema(), *study.state_space);
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
  if (!heading.starts_with('`')) return "";  // above all tables
  const auto end = heading.find('`', 1);
  const bool in_sensor = heading.starts_with("`[sensor.");
  const auto head =
      (in_sensor ? "[[sensor]]\nname = \"s\"\n" : "") + heading.substr(1, end - 1) + "\n";
  const auto kind = heading.find("of kind `");
  if (kind == std::string::npos) return head;
  const auto word = heading.substr(kind + 9);
  return head + "kind = \"" + word.substr(0, word.size() - 1) + "\"\n";
}

/// Whether the reader of a table refuses a key of that name; whatever it says of the value.
bool refuses(const std::string& head, const std::string& key) {
  const auto line = key + " = 0\n";
  const auto message =
      refusal_of([&] { return head.empty() ? with("", line) : with(head + line); });
  return message.find("unknown key") != std::string::npos;
}

TEST(Schema, NamesKeysThatTheReaderKnows) {
  for (const auto& table : tables_of_a_study()) {
    if (table.heading.starts_with("`[geometry") || table.heading.starts_with("`[[geometry") ||
        table.heading.starts_with("`[material")) {
      continue;  // a study has one of each already
    }
    const auto head = head_of(table.heading);
    for (const auto& key : table.keys) EXPECT_FALSE(refuses(head, key.name)) << head << key.name;
    EXPECT_TRUE(head == "[[attachment]]\n" || refuses(head, "no_such_key")) << head;
  }
}

std::string json_of(const std::string& name, const Study& study) {
  if (name == "support") return io::text(io::Json(support_schema().json(study.supports.at(0))));
  if (name == "layout") return io::text(io::Json(layout_schema().json(study.layouts.at(0))));
  if (name == "variation") {
    return io::text(io::Json(variation_schema().json(study.variations.at(0))));
  }
  return io::text(expectations_json(study.expectations));
}

TEST(Schema, ShowsInSiUnitsWhatATableSays) {
  const auto same = [](const std::string& name, const std::string& table, const io::Json& json) {
    EXPECT_EQ(json_of(name, with(table)), io::text(json)) << table;
  };
  same("support", "[[support]]\npatch = \"top\"\nfixed = \"zx\"\n",
       io::JsonObject{{"patch", "top"}, {"fixed", "xz"}});
  same("layout", "[[layout]]\nname = \"none\"\n",
       io::JsonObject{
           {"name", "none"}, {"sensors", io::JsonArray{}}, {"actuators", io::JsonArray{}}});
  same("variation", "[[variation]]\nof = \"stiffness\"\nv2 = \"-2 %\"\nu1 = 0.01\n",
       io::JsonObject{{"of", "stiffness"},
                      {"u1", 0.01},
                      {"v1", 0.0},
                      {"u2", 0.0},
                      {"u1v1", 0.0},
                      {"v2", -0.02}});
  same("variation",
       "[[variation]]\nof = \"thickness\"\nat = [\"1 cm\", \"2 cm\"]\nradius = \"30 mm\"\n"
       "relative = \"-30 %\"\n",
       io::JsonObject{{"of", "thickness"},
                      {"at_m", io::JsonArray{0.01, 0.02}},
                      {"radius_m", 0.03},
                      {"relative", -0.3},
                      {"u1", 0.0},
                      {"v1", 0.0},
                      {"u2", 0.0},
                      {"u1v1", 0.0},
                      {"v2", 0.0}});
  same("expect",
       "[expect]\nmass = { value = \"200 g\", within = \"1 g\" }\n"
       "frequency_2 = { value = \"0.2 kHz\", within = \"1 %\" }\n",
       io::JsonObject{
           {"mass", io::JsonObject{{"value", 0.2}, {"within", 0.001}, {"unit", "kg"}}},
           {"frequency_2", io::JsonObject{{"value", 200.0}, {"within", 2.0}, {"unit", "Hz"}}}});
}

TEST(Schema, SaysWhatIsWrongWithATableAndWhere) {
  const auto says = [](const std::string& top, const std::string& table, const std::string& what) {
    const auto message = refusal_of([&] { return with(table, top); });
    EXPECT_NE(message.find(what), std::string::npos) << message << "\n" << top << table;
  };
  says("seed = -1", "", "plate.toml:1:8: seed is the number -1; expected a whole number from 0 to");
  says("title = 3", "", "plate.toml:1:9: title is the number 3; expected a text that is not empty");
  says("extends = 3", "", "plate.toml:1:11: extends is the number 3, expected the file of a study");
  says("titel = \"a\"", "", "plate.toml:1:1: unknown key \"titel\" in the study; did you mean");
  says("extend = \"a.toml\"", "", "unknown key \"extend\" in the study; did you mean \"extends\"?");
  says("", "[[support]]\nfixed = \"z\"\n", "plate.toml:8:1: support[0] lacks \"patch\"");
  says("", "[[support]]\npatch = \"top\"\nfixed = \"zw\"\n",
       "plate.toml:10:9: support[0].fixed is \"zw\"; expected some of the letters x, y and z");
  says("", "[[layout]]\nname = \"a\"\nsensors = [\"s1\"]\n",
       "plate.toml:10:11: layout[0].sensors names \"s1\", but no sensor of the study has that");
  says("", "[[layout]]\nname = \"a\"\nactuators = \"a1\"\n",
       "layout[0].actuators is the text \"a1\"; expected an array of texts");
  says("", "[[layout]]\nname = \"a\"\n[[layout]]\nname = \"a\"\n",
       "two layouts are called \"a\": line 9 and line 11");
  says("", "[[variation]]\nof = \"stiffness\"\nat = [\"1 cm\", \"2 cm\"]\n",
       "plate.toml:8:1: variation[0] lacks \"radius\"; expected a length such as");
  says("", "[[variation]]\nof = \"stiffness\"\nu1 = \"1 cm\"\n",
       "plate.toml:10:6: variation[0].u1");
  says("", "[expect]\nfrequncy_1 = { value = \"1 Hz\", within = \"1 %\" }\n",
       "plate.toml:9:1: unknown key \"frequncy_1\" in expect; did you mean \"frequency_1\"?");
  says("", "[expect]\nmass = { value = \"1 kg\" }\n",
       "plate.toml:9:8: expect.mass lacks \"within\"");
  says("", "[expect]\nvolume = { value = \"1 kg\", within = \"1 %\" }\n",
       "plate.toml:9:20: expect.volume.value");
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
