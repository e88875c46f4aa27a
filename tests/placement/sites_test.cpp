#include "placement/sites.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "mesh/disc.h"
#include "placement/refine.h"
#include "placement/rules.h"
#include "tests/placement/plate.h"

namespace chladni::placement {
namespace {

// Modes that are polynomials of x and y along z, so that all is known exactly.
struct Known {
  mesh::TetMesh body = mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.4, 0.02}, 0.05, 1), 2);
  modal::Modes modes;
  Known() {
    modes.frequency_hz = Eigen::Vector3d(10, 20, 30);
    modes.damping_ratio = Eigen::Vector3d::Zero();
    modes.shapes = Eigen::MatrixXd::Zero(3 * body.node_count(), 3);
    for (Eigen::Index i = 0; i < body.node_count(); ++i) {
      const double x = body.points(i, 0), y = body.points(i, 1);
      modes.shapes.row(3 * i + 2) << 1.0, x - 2.0 * y, x * x + y * y;
    }
  }
};

TEST(Sites, OfAPatchStandForItsWholeArea) {
  const Known known;
  const Sampler sampler(known.body, known.modes, {});
  EXPECT_NEAR(sampler.surface({"top"}).sites.area.sum(), 0.24, 1e-12);
  EXPECT_NEAR(sampler.surface({}).sites.area.sum(), 2 * 0.24 + 2.0 * 0.02, 1e-12);
  const auto top = sampler.surface({"top"});
  EXPECT_TRUE((top.sites.normal.col(2).array() == 1.0).all());
  EXPECT_THROW((void)sampler.surface({"lid"}), InvalidInput);
}

TEST(Sites, SeeValuesAndSlopesOfAPolynomial) {
  const Known known;
  const Sampler sampler(known.body, known.modes, {});
  const auto sites = sampler.at({*sampler.finder().from_above(0.1, -0.05)});
  EXPECT_NEAR(sites.shapes(0, 1), 0.2, 1e-12);
  EXPECT_NEAR(sites.shapes(0, 2), 0.0125, 1e-12);
  EXPECT_NEAR(sites.slopes(0, 0), 0.0, 1e-9);
  EXPECT_NEAR(sites.slopes(0, 1), std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(sites.slopes(0, 2), 2.0 * std::hypot(0.1, 0.05), 1e-6);
}

TEST(Sites, AFootprintSeesTheMeanOverItsDisc) {
  const Known known;
  const double diameter = 0.06;
  const Sampler sampler(known.body, known.modes, {Eigen::Vector3d::UnitZ(), diameter});
  const auto sites = sampler.at({*sampler.finder().from_above(0.1, -0.05)});
  EXPECT_NEAR(sites.shapes(0, 1), 0.2, 1e-12);
  // Over a disc the mean of r^2 from its centre is R^2 / 2.
  EXPECT_NEAR(sites.shapes(0, 2), 0.0125 + 0.5 * std::pow(0.5 * diameter, 2), 1e-12);
  EXPECT_EQ(sites.whole[0], 1);
  EXPECT_EQ(sampler.at({*sampler.finder().from_above(0.28, 0.0)}).whole[0], 0);
}

TEST(Sites, TheDirectionDecidesWhatIsSeen) {
  const Known known;
  const Sampler sampler(known.body, known.modes, {Eigen::Vector3d::UnitX(), 0.0});
  EXPECT_EQ(sampler.at({*sampler.finder().from_above(0.1, 0.1)}).shapes.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_THROW(Sampler(known.body, known.modes, {Eigen::Vector3d(1, 1, 0), 0.0}), InvalidInput);
}

TEST(Refined, ClimbsToTheTopOfAHill) {
  const Known known;
  const Sampler sampler(known.body, known.modes, {});
  const Eigen::RowVector2d top(0.0731, -0.0412);
  const Worth worth = [&](const Sites& sites) {
    return Eigen::VectorXd(-(sites.position.leftCols<2>().rowwise() - top).rowwise().norm());
  };
  const auto best =
      refined(sampler, sampler.at({*sampler.finder().from_above(-0.2, 0.1)}), worth, 0.05, 1e-6);
  EXPECT_LT((best.position.row(0).head<2>() - top).norm(), 1e-5);
}

TEST(Refined, StaysOnItsFaceAtAnEdge) {
  const Known known;
  const Sampler sampler(known.body, known.modes, {});
  const Worth worth = [](const Sites& sites) {
    return Eigen::VectorXd(sites.position.col(0) -
                           (sites.position.col(1).array() - 0.033).square().matrix());
  };
  const auto best =
      refined(sampler, sampler.at({*sampler.finder().from_above(0.2, 0.1)}), worth, 0.05, 1e-6);
  EXPECT_NEAR(best.position(0, 0), 0.3, 1e-5);
  EXPECT_NEAR(best.position(0, 1), 0.033, 1e-3);
  EXPECT_NEAR(best.position(0, 2), 0.0, 1e-12);
}

class RulesOf : public ::testing::Test {
 protected:
  Known known_;
  Sampler sampler_{known_.body, known_.modes, {}};
  Sites sites_ = sampler_.surface({"top"}).sites;

  double area_left(const std::vector<Rule>& rules) {
    const auto forbidden = forbidden_by(sites_, rules);
    return (forbidden.array() < 0).select(sites_.area, 0.0).sum();
  }
};

TEST_F(RulesOf, ABoxTakesItsInside) {
  const auto forbidden = forbidden_by(sites_, {{"box", KeepOutBox{{0.1, 0.1}, {-0.1, -0.1}}}});
  for (Eigen::Index i = 0; i < sites_.count(); ++i) {
    const bool inside = sites_.position.row(i).head<2>().cwiseAbs().maxCoeff() <= 0.1;
    EXPECT_EQ(forbidden(i) >= 0, inside);
  }
}

TEST_F(RulesOf, EdgesKeepTheirDistance) {
  const auto rule = Rule{"edges", edges_of(known_.body, {"top"}, 0.049)};
  const auto forbidden = forbidden_by(sites_, {rule});
  for (Eigen::Index i = 0; i < sites_.count(); ++i) {
    const auto at = sites_.position.row(i).cwiseAbs();
    const bool near = 0.3 - at.x() < 0.049 || 0.2 - at.y() < 0.049;
    EXPECT_EQ(forbidden(i) >= 0, near) << at;
  }
}

// The distance is that from the circle, not from chords between its nodes.
TEST(EdgesAround, OfARoundPlateAreItsCircle) {
  const mesh::Disc disc{.diameter = 0.2, .thickness = 0.006};
  for (const int order : {2, 3}) {
    auto body = mesh::layered(disc, 0.04, 1);
    mesh::project_to_disc(body, disc, order);
    body = mesh::with_order(body, order);
    mesh::project_to_disc(body, disc, order);
    const auto edges = edges_of(body, {"top"}, 0.005);
    double nearest = HUGE_VAL;
    double farthest = 0.0;
    for (Eigen::Index e = 0; e < edges.from.rows(); ++e) {
      const Eigen::RowVector3d middle = 0.5 * (edges.from.row(e) + edges.to.row(e));
      nearest = std::min(nearest, middle.head<2>().norm());
      farthest = std::max(farthest, edges.from.row(e).head<2>().norm());
    }
    EXPECT_GT(nearest, 0.1 - 3e-5) << order;
    EXPECT_LT(farthest, 0.1 + 3e-5) << order;
  }
}

TEST_F(RulesOf, WhenNothingIsLeftTheLastRuleIsNamed) {
  const std::vector<Rule> rules{{"the left half", KeepOutBox{{-1, -1}, {0, 1}}},
                                {"the right half", KeepOutBox{{0, -1}, {1, 1}}}};
  try {
    (void)admissible(forbidden_by(sites_, rules), rules);
    FAIL();
  } catch (const InvalidInput& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("the left half took"), std::string::npos) << text;
    EXPECT_NE(text.find("the last ones went to the right half"), std::string::npos) << text;
  }
}

TEST_F(RulesOf, DiscPatchAndNeighboursTakeTheirOwn) {
  const double all = area_left({});
  EXPECT_NEAR(all - area_left({{"disc", KeepOutDisc{{0, 0}, 0.2}}}), 0.0314, 0.004);
  EXPECT_EQ(area_left({{"patch", KeepOutPatch{sites_.patch(0)}}}), 0.0);
  Points there(1, 3);
  there << 0.0, 0.0, 0.0;
  EXPECT_NEAR(all - area_left({{"near", KeepFromPlaces{0.1, there}}}), 0.0314, 0.004);
}

}  // namespace
}  // namespace chladni::placement
