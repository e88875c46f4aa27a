// Bodies that vary against bodies that are so.
#include "stage/variation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "stage/solution.h"
#include "tests/app/quiet_run.h"

namespace chladni::stage {
namespace {

const std::string kPlate = R"(
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "50 mm", order = 2 }
modes = { count = 12 }
)";

study::Study parsed(const std::string& more) {
  return study::parse_study(kPlate + more, "bench/study.toml");
}

stage::Solution solved_with(const study::Study& study) {
  const app::TestFolder folder("variation");
  app::QuietRun quiet(study, folder.path());
  return stage::solved(study, quiet.run());
}

const stage::Solution& plain() {
  static const stage::Solution solution = solved_with(parsed(""));
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
  // Factors are kept to a part of 0.5 %, this way and that.
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
  const auto factors = stage::varied_factors(study, body);
  for (Eigen::Index t = 0; t < body.tet_count(); t += 37) {
    // In the mean over places that fill the cell evenly.
    double stiffer = 0.0;
    double heavier = 0.0;
    double count = 0.0;
    for (int i = 0; i < 24; ++i) {
      for (int j = 0; i + j < 24; ++j) {
        for (int k = 0; i + j + k < 24; ++k) {
          const Eigen::Vector4d at =
              (Eigen::Vector4d(i, j, k, 23 - i - j - k).array() + 0.25) / 24.0;
          Eigen::Vector3d place = Eigen::Vector3d::Zero();
          for (int a = 0; a < 4; ++a) place += at(a) * body.points.row(body.tets(t, a)).transpose();
          const double d2 = (place.head<2>() - Eigen::Vector2d(0.1, -0.05)).squaredNorm() / 0.0036;
          const double v = place.y() / 0.2;
          const double thick = 1.0 + 0.1 * (1.5 * v * v - 0.5);
          stiffer += 1.0 - 0.4 * std::exp(-0.25 * std::numbers::pi * d2 * d2);
          heavier += thick;
          count += 1.0;
        }
      }
    }
    EXPECT_NEAR(factors(t, 1), heavier / count, 1e-4) << t;
    EXPECT_NEAR(factors(t, 0), stiffer / count * std::pow(heavier / count, 3), 0.02) << t;
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

// What is small is varied as smoothly as what is large.
TEST(Variation, KeepsEachFactorToAHundredthOfTheLargest) {
  for (const char* field :
       {"of = \"stiffness\"\nu1 = 0.006\nv2 = -0.002\n", "of = \"thickness\"\nu1 = 0.0004\n",
        "of = \"stiffness\"\nu1 = 0.4\n"}) {
    const auto study = parsed(std::string("[[variation]]\n") + field);
    auto body = plain().model.body;
    auto materials = plain().model.materials;
    const Eigen::MatrixX2d wanted = stage::varied_factors(study, body).array() - 1.0;
    stage::vary(study, body, materials);
    const auto& plain_material = plain().model.materials.front();
    const double stiffest = wanted.col(0).cwiseAbs().maxCoeff();
    const double heaviest = wanted.col(1).cwiseAbs().maxCoeff();
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      const auto& own = materials[static_cast<std::size_t>(body.region(t))];
      EXPECT_NEAR(own.stiffness(0, 0) / plain_material.stiffness(0, 0) - 1.0, wanted(t, 0),
                  0.01 * stiffest);
      EXPECT_NEAR(own.density / plain_material.density - 1.0, wanted(t, 1),
                  0.01 * heaviest + 1e-15);
    }
    EXPECT_LE(materials.size(), 520U);
  }
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
}  // namespace chladni::stage
