#include "fem/body/site_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "field_on_plate.h"

namespace chladni::fem {
namespace {

Eigen::VectorXd gathered(const mesh::TetMesh& body, const SiteMotion& motion, const Field& field) {
  Eigen::VectorXd u(3 * motion.nodes.size());
  for (Eigen::Index i = 0; i < motion.nodes.size(); ++i) {
    u.segment<3>(3 * i) = field(body.points.row(motion.nodes(i)).transpose());
  }
  return u;
}

SiteMotion motion_at(const mesh::TetMesh& body, const mesh::Site& site) {
  return point_motion(body, site, tets_below(body, {site}).front());
}

// One pass finds for many sites what a pass each finds; two sites may share a face.
TEST(SiteMotion, FindsTheTetrahedraBelowAllSitesAtOnce) {
  const auto body = plate();
  const mesh::SiteFinder finder(body);
  std::vector<mesh::Site> sites;
  for (int i = 0; i < 50; ++i) {
    sites.push_back(finder.from_above(-0.14 + 0.0057 * i, 0.09 - 0.0035 * i).value());
  }
  sites.push_back(sites.front());
  sites.push_back(mesh::Site{});
  auto elsewhere = sites.front();
  elsewhere.nodes(2) = elsewhere.nodes(1);
  elsewhere.nodes(1) = body.tets(body.tet_count() - 1, 0);
  sites.push_back(elsewhere);
  const auto below = tets_below(body, sites);
  ASSERT_EQ(below.size(), sites.size());
  for (std::size_t i = 0; i < 51; ++i) {
    ASSERT_GE(below[i], 0) << i;
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE((body.tets.row(below[i]).head<4>().array() == sites[i].nodes(k)).any()) << i;
    }
    EXPECT_EQ(below[i], tets_below(body, {sites[i]}).front()) << i;
  }
  EXPECT_EQ(below[50], below[0]);
  EXPECT_EQ(below[51], -1);
  EXPECT_EQ(below[52], -1);
  EXPECT_THROW((void)point_motion(body, sites[0], -1), InvalidInput);
  EXPECT_THROW((void)point_motion(body, sites[0], below[49]), InvalidInput);
  EXPECT_TRUE(tets_below(body, {}).empty());
}

TEST(SiteMotion, OfAPointIsThatOfAQuadraticFieldExactly) {
  const auto body = plate();
  const auto site = site_on(body, 0.033, 0.041);
  const auto motion = motion_at(body, site);
  const Field field = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x.y() * x.z(), x.x() * x.x(), x.x() * x.y());
  };
  const auto u = gathered(body, motion, field);
  const double x = 0.033;
  const double y = 0.041;
  // ½ curl: (∂uz/∂y − ∂uy/∂z, ∂ux/∂z − ∂uz/∂x, ∂uy/∂x − ∂ux/∂y) / 2 on z = 0.
  EXPECT_LT((motion.displacement * u - field({x, y, 0.0})).norm(), 1e-15);
  EXPECT_LT((motion.rotation * u - Eigen::Vector3d(0.5 * x, 0.0, x)).norm(), 1e-13);
}

const Field kBend = [](const Eigen::Vector3d& x) {
  return Eigen::Vector3d(-10.0 * x.z() * std::cos(10.0 * x.x()), 0.0, std::sin(10.0 * x.x()));
};

TEST(SiteMotion, RotationOfABentPlateConvergesWithTheMesh) {
  std::vector<double> errors;
  for (const double edge : {0.05, 0.025, 0.0125}) {
    const auto body = plate(2, edge);
    const mesh::SiteFinder finder(body);
    double sum = 0.0;
    for (int i = 0; i < 40; ++i) {
      const double x = -0.14 + 0.007 * i;
      const auto motion = motion_at(body, finder.from_above(x, 0.09 - 0.0043 * i).value());
      const Eigen::Vector3d turned = motion.rotation * gathered(body, motion, kBend);
      sum += (turned - Eigen::Vector3d(0.0, -10.0 * std::cos(10.0 * x), 0.0)).squaredNorm();
    }
    errors.push_back(std::sqrt(sum / 40.0));
  }
  EXPECT_LT(errors[1], 0.4 * errors[0]);  // order 2
  EXPECT_LT(errors[2], 0.4 * errors[1]);
}

TEST(SiteMotion, OfAFootprintTendsToThatOfThePoint) {
  const auto body = plate(3);
  const auto site = site_on(body, 0.041, 0.013);
  const Field field = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x.y() * x.y(), x.x() * x.x(), 20.0 * x.x() * x.x() * x.y());
  };
  const auto point = motion_at(body, site);
  const Eigen::Vector3d moved = point.displacement * gathered(body, point, field);
  const double in_plane_turn = (point.rotation * gathered(body, point, field))(2);
  std::vector<double> errors;
  for (const double diameter : {4e-2, 2e-2, 1e-2}) {
    const auto disc = footprint_motion(body, site, diameter);
    const auto u = gathered(body, disc, field);
    errors.push_back((disc.displacement * u - moved).norm());
    EXPECT_NEAR((disc.rotation * u)(2), in_plane_turn, 1e-5);  // a linear gradient: its mean
  }
  EXPECT_NEAR(errors[0] / errors[1], 4.0, 0.1);
  EXPECT_NEAR(errors[1] / errors[2], 4.0, 0.1);
}

TEST(SiteMotion, OfAFootprintIsTheMeanOverTheDisc) {
  const auto body = plate();
  const auto site = site_on(body, 0.0, 0.0);
  const auto disc = footprint_motion(body, site, 0.12);
  const Field bowl = [](const Eigen::Vector3d& x) { return Eigen::Vector3d(0, 0, x.x() * x.x()); };
  // Mean of x² over a disc: r²/4.
  EXPECT_NEAR((disc.displacement * gathered(body, disc, bowl))(2), 0.06 * 0.06 / 4.0, 1e-3 * 9e-4);
}

TEST(SiteMotion, OfAFootprintLeavesTheOtherSideOut) {
  const auto body = plate();
  const auto disc = footprint_motion(body, site_on(body, 0.0, 0.0), 0.5);  // the whole top
  for (Eigen::Index i = 0; i < disc.nodes.size(); ++i) {
    EXPECT_EQ(body.points(disc.nodes(i), 2), 0.0);
  }
  const Field field = [](const Eigen::Vector3d& x) { return Eigen::Vector3d(0, 0, x.x() * x.x()); };
  EXPECT_NEAR((disc.displacement * gathered(body, disc, field))(2), 0.3 * 0.3 / 12.0, 1e-12);
}

TEST(SiteMotion, RefusesAFootprintThatTakesInTooMuch) {
  const auto fine = plate(2, 0.01);
  EXPECT_THROW((void)footprint_motion(fine, site_on(fine, 0.0, 0.0), 1.0), InvalidInput);
}

TEST(SiteMotion, RefusesASiteOfAnotherMesh) {
  const auto site = site_on(plate(3), 0.0, 0.0);
  EXPECT_THROW((void)motion_at(plate(2), site), InvalidInput);
}

}  // namespace
}  // namespace chladni::fem
