// What an experiment would find, as people read it.
#include "show/diagnosis/detectable_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chladni::show {
namespace {

// A mass that is found, and a sign that brings so much evidence.
std::vector<diagnosis::Detectable> sizes(double log_evidence) {
  std::vector<diagnosis::Detectable> all;
  for (const auto* of : {"worst", "median", "best"}) {
    diagnosis::Detectable mass;
    mass.effect = "point_mass";
    mass.of = of;
    mass.parameter = "mass";
    mass.unit = "kg";
    mass.size = 0.01;
    all.push_back(mass);
  }
  diagnosis::Detectable unit;
  unit.effect = "sensor_unit";
  unit.of = "worst";
  unit.channels = {"s2"};
  unit.option = "inch taken for mm";
  unit.size = std::nan("");
  unit.log_evidence = log_evidence;
  all.push_back(unit);
  return all;
}

TEST(DetectableSentence, SaysWhatTheStudysOwnThresholdMisses) {
  const auto between = sizes(12.0);
  EXPECT_EQ(show::detectable_sentence(between, 8.0).find("miss"), std::string::npos);
  EXPECT_NE(show::detectable_sentence(between, 20.0)
                .find("It may miss: sensor_unit (s2: inch taken for mm)."),
            std::string::npos)
      << show::detectable_sentence(between, 20.0);
  EXPECT_NE(show::detectable_table(between, 20.0).find("It may miss"), std::string::npos);
}

TEST(DetectableTable, HasNoExponentInASize) {
  auto all = sizes(12.0);
  for (auto& one : all) {
    if (one.unit == "kg") one.size = 0.0998;
  }
  const auto table = show::detectable_table(all, 8.0);
  EXPECT_NE(table.find("100 g"), std::string::npos) << table;
  EXPECT_EQ(table.find("e+0"), std::string::npos) << table;
}

TEST(DetectableJson, SaysWhichUnit) {
  const io::Json json = show::detectable_json(sizes(12.0));
  EXPECT_EQ(json.array().back().at("option").string(), "inch taken for mm");
}

}  // namespace
}  // namespace chladni::show
