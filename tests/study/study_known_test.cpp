// Numbers of a study that say how well they are known.
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "study/study.h"
#include "tests/refusal.h"

namespace chladni::study {
namespace {

using Kind = diagnosis::CalibratedConstant::Kind;

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct Numbers {
  std::string modulus = R"("70 GPa")", density = R"("2700 kg/m^3")", thickness = R"("12 mm")";
};

Study with(const Numbers& numbers, const std::string& more = "") {
  return parse_study(
      "geometry = { plate = { length = \"400 mm\", width = \"300 mm\", thickness = " +
          numbers.thickness + " } }\nmaterial = { youngs_modulus = " + numbers.modulus +
          ", poissons_ratio = 0.33, density = " + numbers.density + " }\n" + more,
      "plate.toml");
}

std::string refusal(const Numbers& numbers, const std::string& more = "") {
  return refusal_of([&] { return with(numbers, more); });
}

const std::string kWood = R"(
geometry = { plate = { length = "500 mm", width = "200 mm", thickness = "4 mm" } }
[material]
symmetry = "orthotropic"
poissons_ratio = [0.3, 0.4, 0.39]
density = "400 kg/m^3"
)";

TEST(KnownNumbers, AreThoseOfThePlainStudyWithTheirDeviations) {
  const auto plain = with({});
  EXPECT_TRUE(plain.constants.empty());
  const auto study = with({.modulus = R"({ value = "70 GPa", within = "15 %" })",
                           .density = R"({ value = "2700 kg/m^3", measured = "0.6 %" })",
                           .thickness = R"({ value = "12 mm", unknown = true })"},
                          "modes = { damping_ratio = { value = 0.01, within = \"50 %\" } }");
  EXPECT_EQ(study.materials[0].constants, plain.materials[0].constants);
  EXPECT_DOUBLE_EQ(study.modes.damping_ratio, 0.01);
  ASSERT_EQ(study.constants.size(), 4U);
  const auto expect = [&](const std::string& name, double value, double deviation, Kind kind,
                          const std::string& effect) {
    for (const auto& one : study.constants) {
      if (one.name != name) continue;
      EXPECT_DOUBLE_EQ(one.value, value) << name;
      EXPECT_DOUBLE_EQ(one.deviation, deviation) << name;
      EXPECT_EQ(one.kind, kind) << name;
      EXPECT_EQ(one.effect, effect) << name;
      return;
    }
    FAIL() << name;
  };
  expect("material.youngs_modulus", 70e9, 0.15, Kind::known, "youngs_modulus");
  expect("material.density", 2700.0, 0.006, Kind::measured, "density");
  expect("geometry.plate.thickness", 0.012, 0.0, Kind::unknown, "thickness");
  expect("modes.damping_ratio", 0.01, 0.5, Kind::known, "modal_damping");
}

TEST(KnownNumbers, OfWoodStandInItsArrays) {
  const auto one_by_one = parse_study(
      kWood + R"(youngs_modulus = [{ value = "10.6 GPa", within = "15 %" }, "0.9 GPa", "0.5 GPa"]
shear_modulus = ["0.05 GPa", "0.7 GPa", { value = "0.7 GPa", within = "20 %" }]
)",
      "wood.toml");
  ASSERT_EQ(one_by_one.constants.size(), 2U);
  EXPECT_EQ(one_by_one.constants[0].effect, "stiffness_along_u");
  EXPECT_EQ(one_by_one.constants[1].effect, "shear_stiffness");
  EXPECT_EQ(one_by_one.constants[1].name, "material.shear_modulus[2]");
  const auto together = parse_study(
      kWood + R"(youngs_modulus = { value = ["10.6 GPa", "0.9 GPa", "0.5 GPa"], within = "15 %" }
shear_modulus = ["0.05 GPa", "0.7 GPa", "0.7 GPa"]
)",
      "wood.toml");
  ASSERT_EQ(together.constants.size(), 2U);
  EXPECT_EQ(together.constants[1].effect, "stiffness_along_v");
  EXPECT_DOUBLE_EQ(together.constants[1].value, 0.9e9);
}

TEST(KnownNumbers, AreRefusedInWords) {
  const auto modulus = [](const std::string& statement) {
    return refusal({.modulus = "{ value = \"70 GPa\", " + statement + " }"});
  };
  EXPECT_PRED2(says, modulus("within = \"-5 %\""), "above 0 such as \"15 %\"");
  EXPECT_PRED2(says, modulus("within = \"5 GPa\""), "above 0 such as \"15 %\"");
  EXPECT_PRED2(says, modulus("within = 0.15"), "above 0 such as \"15 %\"");
  EXPECT_PRED2(says, modulus("within = \"many %\""), "above 0 such as \"15 %\"");
  EXPECT_PRED2(says, modulus("measured = \"0 %\""), "above 0 such as \"15 %\"");
  EXPECT_PRED2(says, modulus("within = \"5 %\", unknown = true"), "more than one of");
  EXPECT_PRED2(says, modulus("unknown = false"), "expected true");
  EXPECT_PRED2(says, modulus("within = \"5 %\", std = 1"), "unknown key \"std\"");
  EXPECT_PRED2(says, refusal({.modulus = R"({ value = "70 m", within = "5 %" })"}),
               "youngs_modulus");
  EXPECT_PRED2(says, refusal({.modulus = R"({ within = "5 %" })"}), "youngs_modulus");
}

TEST(KnownNumbers, AreThoseThatADiagnosisCanCalibrate) {
  const auto told = refusal({}, "mesh = { edge_length = { value = \"20 mm\", within = \"5 %\" } }");
  EXPECT_PRED2(says, told, "mesh.edge_length states how well it is known");
  EXPECT_PRED2(says, told, "material.density");
  EXPECT_PRED2(says, told, "modes.damping_ratio");
  EXPECT_PRED2(says, refusal({}, "modes = { damping_ratio = { value = 0, within = \"5 %\" } }"),
               "no relative deviation");
  EXPECT_PRED2(says, refusal({}, R"([[attachment]]
kind = "mass"
name = "m"
at = ["0 mm", "0 mm"]
mass = { value = "1 kg", within = "5 %" }
)"),
               "attachment[0].mass");
}

TEST(KnownNumbers, OfATurnedMaterialAreRefused) {
  try {
    static_cast<void>(parse_study(kWood + R"(angle = "30 deg"
youngs_modulus = { value = ["10.6 GPa", "0.9 GPa", "0.5 GPa"], within = "15 %" }
shear_modulus = ["0.05 GPa", "0.7 GPa", "0.7 GPa"]
)",
                                  "wood.toml"));
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_PRED2(says, std::string(e.what()), "angle or axes");
  }
}

TEST(KnownNumbers, LeaveExpectationsAlone) {
  const auto study = with({}, "[expect]\nfrequency_1 = { value = \"100 Hz\", within = \"1 %\" }\n");
  EXPECT_TRUE(study.constants.empty());
  EXPECT_DOUBLE_EQ(study.expectations.at(0).within, 1.0);
}

}  // namespace
}  // namespace chladni::study
