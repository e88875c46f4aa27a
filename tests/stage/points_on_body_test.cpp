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
  const auto sites = sites_near(finder, points, reach_of(body));
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
      refused([&] { return sites_near(finder, points, reach_of(body)); },
              "point 1 at (0, 0, 1.1) mm is 1.1 mm off the surface of the body; nearest is"));
  points(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(
      refused([&] { return sites_near(finder, points, reach_of(body)); }, "point 0 is not finite"));
}

// A millimetre is far from a body of three.
TEST(PointsOnBody, OfASmallBodyAreNearIt) {
  auto body = plate();
  body.points *= 0.01;
  const mesh::SiteFinder finder(body);
  Points points(1, 3);
  points << 0.0, 0.0, 2e-5;
  EXPECT_EQ(sites_near(finder, points, reach_of(body)).size(), 1U);
  points(0, 2) = 5e-4;
  EXPECT_TRUE(refused([&] { return sites_near(finder, points, reach_of(body)); },
                      "point 0 at (0, 0, 0.5) mm is 0.5 mm off the surface of the body"));
}

TEST(PointsOnBody, HaveTheirNormalsOrGivenDirections) {
  const auto body = plate();
  const mesh::SiteFinder finder(body);
  Points points(2, 3);
  points << 0.0, 0.0, 0.0, 0.1, 0.0, -0.01;
  const auto sites = sites_near(finder, points, reach_of(body));
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

// Warnings of an attachment to a plate of 300 x 200 x 10 mm.
std::vector<std::string> warnings_of(const std::string& attachment, double edge = 0.05) {
  const auto study = study::parse_study(
      "[geometry]\nplate = { length = \"300 mm\", width = \"200 mm\", thickness = \"10 mm\" }\n"
      "[material]\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.33\n"
      "density = \"2700 kg/m^3\"\n"
      "[[attachment]]\nname = \"motor\"\n" +
          attachment,
      "study.toml");
  const mesh::Plate body{.length = 0.3, .width = 0.2, .thickness = 0.01};
  return places_of(study, mesh::layered(body, edge, 1)).warnings;
}

// A finer mesh, which is what else would be advised, makes it worse.
TEST(PlacesOfAttachments, AMassThatTurnsAPointAsksForAFootprint) {
  const std::string mass = "kind = \"mass\"\nat = [\"60 mm\", \"50 mm\"]\nmass = \"1 kg\"\n";
  const std::string inertia = mass + "inertia = [\"0 kg m^2\", \"3e-3 kg m^2\", \"0 kg m^2\"]\n";
  EXPECT_TRUE(warnings_of(mass).empty());
  EXPECT_TRUE(warnings_of(inertia + "footprint = \"40 mm\"\n").empty());
  const auto found = warnings_of(inertia);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("attachment \"motor\""), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("footprint ="), std::string::npos) << found[0];
}

// A torsion spring of 10 kN m/rad at a point: a block of 120 mm had 615 Hz on cells of 40 mm and
// 216 Hz on cells of 5 mm.
TEST(PlacesOfAttachments, AStiffSpringAtAPointAsksForAFootprint) {
  const auto turning = [](const std::string& stiffness) {
    return "kind = \"torsion_spring\"\nat = [\"60 mm\", \"50 mm\"]\naxis = \"y\"\nstiffness = \"" +
           stiffness + " N m/rad\"\n";
  };
  EXPECT_EQ(warnings_of(turning("1e5")).size(), 1U);
  EXPECT_TRUE(warnings_of(turning("1e5") + "footprint = \"40 mm\"\n").empty());
  EXPECT_TRUE(warnings_of(turning("20")).empty());
  EXPECT_EQ(warnings_of(turning("1e3"), 0.01).size(), 1U);
  const auto holding = [](const std::string& stiffness) {
    return "kind = \"spring\"\nat = [\"60 mm\", \"50 mm\"]\ndirection = \"z\"\nstiffness = \"" +
           stiffness + " N/m\"\n";
  };
  EXPECT_EQ(warnings_of(holding("1e9")).size(), 1U);
  EXPECT_TRUE(warnings_of(holding("1e6")).empty());
}

TEST(PlacesOfAttachments, AFootprintBeyondAnEdgeIsSaid) {
  const auto at = [](const std::string& x, const std::string& y) {
    return "kind = \"mass\"\nmass = \"1 kg\"\nfootprint = \"40 mm\"\nat = [\"" + x + " mm\", \"" +
           y + " mm\"]\n";
  };
  EXPECT_TRUE(warnings_of(at("130", "0")).empty());
  const auto corner = warnings_of(at("150", "100"));
  ASSERT_EQ(corner.size(), 1U);
  EXPECT_NE(corner[0].find("25 % of its footprint of 40 mm lies on the body"), std::string::npos)
      << corner[0];
}

// A hundredth of the body's size is far for a body of 3 mm as for one of 300 mm.
TEST(PlacesOfAttachments, OfASmallBodyAreNearIt) {
  const auto faults = [](const std::string& z) {
    const auto study = study::parse_study(
        "[geometry]\nplate = { length = \"3 mm\", width = \"2 mm\", thickness = \"0.1 mm\" }\n"
        "[material]\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.33\n"
        "density = \"2700 kg/m^3\"\n"
        "[[sensor]]\nname = \"s\"\ndirection = \"z\"\nat = [\"0 mm\", \"0 mm\", \"" +
            z + " mm\"]\n",
        "study.toml");
    const mesh::Plate body{.length = 3e-3, .width = 2e-3, .thickness = 1e-4};
    return refusal_of([&] { return places_of(study, mesh::layered(body, 5e-4, 1)); });
  };
  EXPECT_EQ(faults("0.02"), "");
  EXPECT_NE(faults("0.5").find("is 0.5 mm off the body"), std::string::npos);
}

// Two of eight columns lie beyond the plate of 300 mm.
TEST(PlacesOfAGrid, BeyondTheBodyAreCounted) {
  const auto notes = [](int columns) {
    const auto study = study::parse_study(
        "[geometry]\nplate = { length = \"300 mm\", width = \"300 mm\", thickness = \"10 mm\" }\n"
        "[material]\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.33\n"
        "density = \"2700 kg/m^3\"\n[placement]\ngrid = { pitch = \"60 mm\", columns = " +
            std::to_string(columns) + ", rows = 5 }\n",
        "study.toml");
    const mesh::Plate body{.length = 0.3, .width = 0.3, .thickness = 0.01};
    return model_of(study, mesh::layered(body, 0.05, 1)).notes;
  };
  EXPECT_TRUE(notes(4).empty());
  const auto beyond = notes(8);
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_NE(beyond[0].find("10 of its 40 places"), std::string::npos) << beyond[0];
}

}  // namespace
}  // namespace chladni::stage
