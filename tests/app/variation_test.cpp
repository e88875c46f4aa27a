// Bodies that vary against bodies that are so.
#include "app/variation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/solution.h"
#include "base/error.h"
#include "quiet_run.h"

namespace chladni::app {
namespace {

const std::string kPlate = R"(
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "50 mm", order = 2 }
modes = { count = 12 }
)";

Study parsed(const std::string& more) { return parse_study(kPlate + more, "bench/study.toml"); }

Solution solved_with(const Study& study) {
  const TestFolder folder("variation");
  QuietRun quiet(study, folder.path());
  return solved(study, quiet.run());
}

const Solution& plain() {
  static const Solution solution = solved_with(parsed(""));
  return solution;
}

TEST(Variation, OfNothingChangesNothing) {
  const auto study = parsed("[[variation]]\nof = \"thickness\"\nu1 = 0\n");
  const auto solution = solved_with(study);
  EXPECT_EQ(solution.modes.frequency_hz, plain().modes.frequency_hz);
  EXPECT_EQ(solution.model.materials.size(), 1U);
}

TEST(Variation, OfThicknessLeavesTheMassOfAnOddWave) {
  const auto solution = solved_with(parsed("[[variation]]\nof = \"thickness\"\nu1 = \"10 %\"\n"));
  // Factors are kept to half of 0.5 %, this way and that.
  EXPECT_NEAR(solution.model.mass.mass_kg, plain().model.mass.mass_kg, 5e-4 * 6.48);
  // Heavier at its far end: ∫ u² over ∫ 1 is a third of half the length.
  EXPECT_NEAR(solution.model.mass.centre_m.x(), 0.1 * 0.3 / 3.0, 2e-4);
  EXPECT_GT(solution.model.materials.size(), 10U);
  EXPECT_EQ(solution.model.body.region_names.size(), solution.model.materials.size());
}

TEST(Variation, FactorsAreThoseOfTheFormula) {
  const auto study = parsed(R"([[variation]]
of = "stiffness"
at = ["100 mm", "-50 mm"]
radius = "60 mm"
relative = "-40 %"
[[variation]]
of = "thickness"
v2 = 0.1
)");
  const auto& body = plain().model.body;
  const auto factors = varied_factors(study, body);
  for (Eigen::Index t = 0; t < body.tet_count(); t += 37) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centre += 0.25 * body.points.row(body.tets(t, a)).transpose();
    const double d2 = (centre.head<2>() - Eigen::Vector2d(0.1, -0.05)).squaredNorm() / 0.0036;
    const double patch = 1.0 - 0.4 * std::exp(-0.25 * std::numbers::pi * d2 * d2);
    const double v = centre.y() / 0.2;
    const double thick = 1.0 + 0.1 * (1.5 * v * v - 0.5);
    EXPECT_NEAR(factors(t, 0), patch * std::pow(thick, 3), 1e-12);
    EXPECT_NEAR(factors(t, 1), thick, 1e-12);
  }
}

// To first order only waves that are even count, each by the energy it finds.
TEST(Variation, OfStiffnessRaisesTheFrequencyAsTheMatricesSay) {
  const auto up = solved_with(parsed("[[variation]]\nof = \"stiffness\"\nu2 = 0.1\n"));
  const auto down = solved_with(parsed("[[variation]]\nof = \"stiffness\"\nu2 = -0.1\n"));
  for (Eigen::Index j = 6; j < 12; ++j) {
    const double f = plain().modes.frequency_hz(j);
    const double mean = 0.5 * (up.modes.frequency_hz(j) + down.modes.frequency_hz(j));
    EXPECT_NEAR(mean, f, 3e-3 * f) << j;
  }
  EXPECT_GT((up.modes.frequency_hz - plain().modes.frequency_hz).cwiseAbs().maxCoeff(), 1.0);
}

TEST(VariationRefuses, WhatCannotBe) {
  const auto says = [](const std::string& more, const std::string& part) {
    try {
      static_cast<void>(parsed("[[variation]]\n" + more));
      FAIL() << more << " was taken";
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  says("u1 = 0.1\n", "lacks \"of\"");
  says("of = \"thickness\"\n", "a patch (at, radius, relative) or waves");
  says("of = \"stiffnes\"\nu1 = 0.1\n", "did you mean \"stiffness\"");
  says("of = \"stiffness\"\nat = [\"0 mm\", \"0 mm\"]\nrelative = 0.1\n", "lacks \"radius\"");
  says("of = \"stiffness\"\nat = [\"0 mm\", \"0 mm\"]\nradius = \"1 cm\"\nrelative = -1\n",
       "more than -1");
  says("of = \"stiffness\"\nw1 = 0.1\nu1 = 0.1\n", "unknown key \"w1\"");
  EXPECT_THROW(
      static_cast<void>(solved_with(parsed("[[variation]]\nof = \"stiffness\"\nu1 = 1.2\n"))),
      InvalidInput);
}

}  // namespace
}  // namespace chladni::app
