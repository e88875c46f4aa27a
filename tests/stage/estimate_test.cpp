// Forecasts and default cells of a body do not depend on how it is turned.
#include "stage/estimates/estimate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>
#include <utility>

#include "mesh/bodies.h"
#include "stage/estimates/blind_spots.h"
#include "stage/forecast.h"

namespace chladni::stage {
namespace {

Understood turned(const mesh::Plate& body, const Eigen::Vector3d& axis, double degrees) {
  const auto study = study::parse_study(
      "geometry = { plate = { length = \"1 m\", width = \"1 m\", thickness = \"1 m\" } }\n"
      "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\" "
      "}\n",
      "body.toml");
  Outline outline;
  outline.shell = mesh::layered(body, 0.1 * body.length, 1);
  const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180.0, axis.normalized());
  outline.shell.points = outline.shell.points * turn.toRotationMatrix().transpose();
  outline.volume = body.length * body.width * body.thickness;
  return understood(study, outline);
}

// A strip of 1000 x 8 x 2 mm across its box had 11 000 modes below 2 kHz, which is 36, and such a
// study was refused.
TEST(Understood, KnowsABodyHoweverItIsTurned) {
  for (const auto& body : {mesh::Plate{1.0, 0.008, 0.002}, mesh::Plate{0.3, 0.2, 0.015}}) {
    const auto straight = turned(body, Eigen::Vector3d::UnitZ(), 0.0);
    EXPECT_EQ(straight.sides_m(0), straight.extent_m(0));
    for (const auto& axis : {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(1.0, 2.0, 3.0)}) {
      for (const double degrees : {30.0, 45.0, 71.0}) {
        const auto other = turned(body, axis, degrees);
        EXPECT_NEAR(other.first_frequency_hz / straight.first_frequency_hz, 1.0, 0.1) << degrees;
        EXPECT_NEAR(modes_below(other, 2e3) / modes_below(straight, 2e3), 1.0, 0.1) << degrees;
        EXPECT_EQ(other.mass_kg, straight.mass_kg);
      }
    }
  }
}

// Axes of equal area are told by rounding: a square bar that is turned about its length had sides
// of 28 mm, a cube up to one and a half times its own.
TEST(Understood, KnowsBodiesOfEqualSidesHoweverTheyAreTurned) {
  for (const auto& body : {mesh::Plate{1.0, 0.02, 0.02}, mesh::Plate{0.1, 0.1, 0.1}}) {
    for (const auto& axis : {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(1.0, 2.0, 3.0)}) {
      for (const double degrees : {20.0, 45.0}) {
        const auto other = turned(body, axis, degrees);
        EXPECT_NEAR(other.sides_m(0) / body.length, 1.0, 0.05) << degrees;
        EXPECT_NEAR(other.sides_m(2) / body.thickness, 1.0, 0.05) << degrees;
      }
    }
  }
}

// A cantilever has a sixth of the frequency of the free beam.
TEST(Understood, SaysThatItsFrequencyIsThatOfTheFreeBody) {
  const std::string beam =
      "geometry = { beam = { length = \"300 mm\", width = \"20 mm\", thickness = \"5 mm\" } }\n"
      "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\" "
      "}\n";
  const auto line = [](const std::string& text) {
    const auto study = study::parse_study(text, "body.toml");
    return understood(study, outline_of(study)).line();
  };
  EXPECT_TRUE(line(beam).ends_with("first beam estimate 291 Hz")) << line(beam);
  const auto held = line(beam + "support = [{ patch = \"x_min\", fixed = \"xyz\" }]\n");
  EXPECT_TRUE(held.ends_with("first beam estimate 291 Hz, were it free")) << held;
}

// Its default cells were those of the box around it: one layer or two.
TEST(Quadrilateral, IsLaidAlikeHoweverItIsTurned) {
  const auto cells = [](double degrees) {
    const Eigen::Rotation2Dd turn(degrees * std::numbers::pi / 180.0);
    std::string corners;
    for (const auto& [x, y] :
         {std::pair(-150.0, -100.0), {150.0, -100.0}, {150.0, 100.0}, {-150.0, 100.0}}) {
      const Eigen::Vector2d at = turn * Eigen::Vector2d(x, y);
      corners += fmt::format("[\"{:.12g} mm\", \"{:.12g} mm\"], ", at.x(), at.y());
    }
    const auto study = study::parse_study(
        "geometry = { quadrilateral = { corners = [" + corners +
            "], thickness = \"10 mm\" } }\n"
            "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 "
            "kg/m^3\" }\nmesh = { order = 2 }\n",
        "body.toml");
    return outline_of(study).shell.tet_count();
  };
  for (const double degrees : {30.0, 45.0, 90.0}) EXPECT_EQ(cells(degrees), cells(0.0)) << degrees;
}

// A block on a spring with a dashpot, stiff beside it: ζ = c / (2 √(k m)).
TEST(Dashpots, AreSaidToBeLeftOutOfTheModes) {
  const auto warnings = [](const std::string& damping) {
    const auto study = study::parse_study(
        "geometry = { plate = { length = \"100 mm\", width = \"100 mm\", thickness = \"100 mm\" } "
        "}\n"
        "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 "
        "kg/m^3\" }\nmesh = { order = 1, edge_length = \"50 mm\" }\n"
        "modes = { count = 2, damping_ratio = 0.01 }\n"
        "[[attachment]]\nkind = \"spring\"\nname = \"k\"\nat = [\"0 mm\", \"0 mm\"]\n"
        "direction = \"z\"\nstiffness = \"2700 N/m\"\ndamping = \"" +
            damping + " N s/m\"\n",
        "body.toml");
    Work work;
    auto found = left_out_dashpots(solved(study, work));
    return found.empty() ? std::string() : found.front();
  };
  // 2.7 kg at 5.03 Hz
  EXPECT_NE(warnings("17.07630").find("damping ratio to mode 6 (5.03 Hz) 0.1"), std::string::npos)
      << warnings("17.07630");
  EXPECT_EQ(warnings("0"), "");
  EXPECT_EQ(warnings("0.1"), "");
}

}  // namespace
}  // namespace chladni::stage
