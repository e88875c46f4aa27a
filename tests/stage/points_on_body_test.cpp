#include "stage/points_on_body.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "mesh/bodies.h"
#include "stage/model.h"
#include "tests/refusal.h"

namespace chladni::stage {
namespace {

mesh::TetMesh plate() {
  return mesh::layered(mesh::Plate{.length = 0.3, .width = 0.2, .thickness = 0.01}, 0.05, 1);
}

template <typename Call>
bool refused(const Call& call, const std::string& words) {
  return refusal_of(call).find(words) != std::string::npos;
}

TEST(PointsOnBody, AreMovedOntoTheSurface) {
  const auto body = plate();
  const mesh::SiteFinder finder(body);
  Points points(2, 3);
  points << 0.05, -0.02, 0.0009, 0.15, 0.01, -0.004;
  const auto sites = sites_near(finder, points);
  ASSERT_EQ(sites.size(), 2U);
  EXPECT_NEAR((sites[0].position - Eigen::Vector3d(0.05, -0.02, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((sites[1].normal - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-9);
}

TEST(PointsOnBody, OffTheBodyAreRefusedWithRowAndPlace) {
  const auto body = plate();
  const mesh::SiteFinder finder(body);
  Points points(2, 3);
  points << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0011;
  EXPECT_TRUE(
      refused([&] { return sites_near(finder, points); },
              "point 1 at (0, 0, 1.1) mm is 1.1 mm off the surface of the body; nearest is"));
  points(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([&] { return sites_near(finder, points); }, "point 0 is not finite"));
}

TEST(PointsOnBody, HaveTheirNormalsOrGivenDirections) {
  const auto body = plate();
  const mesh::SiteFinder finder(body);
  Points points(2, 3);
  points << 0.0, 0.0, 0.0, 0.1, 0.0, -0.01;
  const auto sites = sites_near(finder, points);
  const Points normals = directions_at(sites, std::nullopt);
  EXPECT_NEAR(normals(0, 2), 1.0, 1e-12);
  EXPECT_NEAR(normals(1, 2), -1.0, 1e-12);
  Points one(1, 3);
  one << 3.0, 0.0, 4.0;
  const Points given = directions_at(sites, one);
  EXPECT_NEAR((given.row(1) - Eigen::RowVector3d(0.6, 0.0, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_TRUE(refused([&] { return directions_at(sites, Points(Points::Zero(1, 3))); },
                      "any length but 0"));
  EXPECT_TRUE(refused([&] { return directions_at(sites, Points(Points::Ones(3, 3))); },
                      "there are 3 directions for 2 points"));
}

// A finer mesh, which is what else would be advised, makes it worse.
TEST(PlacesOfAttachments, AMassThatTurnsAPointAsksForAFootprint) {
  const auto warnings = [](const std::string& more) {
    const auto study = study::parse_study(
        "[geometry]\nplate = { length = \"300 mm\", width = \"200 mm\", thickness = \"10 mm\" }\n"
        "[material]\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.33\n"
        "density = \"2700 kg/m^3\"\n"
        "[[attachment]]\nname = \"motor\"\nkind = \"mass\"\nat = [\"60 mm\", \"50 mm\"]\n"
        "mass = \"1 kg\"\n" +
            more,
        "study.toml");
    return places_of(study, plate()).warnings;
  };
  const std::string inertia = "inertia = [\"0 kg m^2\", \"3e-3 kg m^2\", \"0 kg m^2\"]\n";
  EXPECT_TRUE(warnings("").empty());
  EXPECT_TRUE(warnings(inertia + "footprint = \"40 mm\"\n").empty());
  const auto found = warnings(inertia);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("attachment \"motor\""), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("footprint ="), std::string::npos) << found[0];
}

}  // namespace
}  // namespace chladni::stage
