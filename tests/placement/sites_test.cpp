#include "placement/sites.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "mesh/disc.h"
#include "mesh/faces.h"
#include "mesh/facing.h"
#include "placement/best_pairs.h"
#include "placement/refine.h"
#include "placement/rules.h"
#include "placement/wanted_modes.h"
#include "tests/placement/plate.h"
#include "tests/refusal.h"

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

// The rim of a disc on a round body lies above its surface, where no device reaches beyond an edge.
TEST(Sites, AFootprintLiesOnABentPlateAsOnAFlatOne) {
  constexpr double kRadius = 0.2;
  Known known;
  for (auto point : known.body.points.rowwise()) {
    const double angle = point.x() / kRadius;
    const double r = kRadius + point.z();
    point << r * std::sin(angle), point.y(), r * std::cos(angle) - kRadius;
  }
  const Sampler sampler(known.body, known.modes, {std::nullopt, 0.06});
  const auto whole_at = [&](double x, double y) {
    const double angle = x / kRadius;
    const Eigen::Vector3d at(0.21 * std::sin(angle), y, 0.21 * std::cos(angle) - kRadius);
    return sampler.at({sampler.finder().nearest(at)}).whole[0];
  };
  EXPECT_EQ(whole_at(0.1, -0.05), 1);
  EXPECT_EQ(whole_at(-0.2, 0.1), 1);
  EXPECT_EQ(whole_at(0.28, 0.0), 0);   // 20 mm from the end
  EXPECT_EQ(whole_at(0.0, 0.185), 0);  // 15 mm from the side
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

// The top's part of x below −0.1 m as a patch of its own, "left".
Known with_a_left_patch() {
  Known known;
  auto& body = known.body;
  body.patch_names.emplace_back("left");
  const int top = mesh::patch_number(body, "top", "test");
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    double x = 0.0;
    for (int corner = 0; corner < 3; ++corner) x += body.points(body.faces(f, corner), 0) / 3.0;
    if (body.face_patch(f) == top && x < -0.1) {
      body.face_patch(f) = static_cast<int>(body.patch_names.size()) - 1;
    }
  }
  return known;
}

TEST(Refined, StaysOnThePatchOfADevice) {
  const auto known = with_a_left_patch();
  const Sampler sampler(known.body, known.modes, {Eigen::Vector3d::UnitZ(), 0.0});
  const auto surface = sampler.surface({"left"});
  Structure structure;
  structure.frequency_hz = known.modes.frequency_hz;
  structure.damping_ratio = known.modes.damping_ratio;
  structure.mass_kg = 1.0;
  structure.size = 0.7;
  Plan plan;
  plan.modes = {2};  // x - 2 y, largest at the corner of "left", and as large at (0.3, -0.2)
  std::vector<std::string> notes;
  const PairViews views(structure, surface.sites,
                        wanted_modes(structure, surface.sites, plan, notes), plan);
  const auto best =
      best_pairs(views, surface.sites, candidates_on(surface, {}), plan, &sampler, {}).best;
  ASSERT_FALSE(best.empty());
  for (const auto& pair : best) EXPECT_LT(pair.position.x(), -0.1 + 1e-9);
  EXPECT_NEAR((best[0].position - Eigen::Vector3d(-0.3, 0.2, 0.0)).norm(), 0.0, 1e-9);
}

// Nothing of a curved face's border is an edge or the border of a patch.
TEST(Refined, StaysOnThePartOfASphereThatLooksUp) {
  auto body = mesh::with_order(mesh::layered(mesh::Plate{0.12, 0.12, 0.01}, 0.01, 1), 2);
  const double radius = 0.1;
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {  // down by what a sphere falls
    const double square = body.points.row(i).head<2>().squaredNorm();
    body.points(i, 2) -= radius - std::sqrt(radius * radius - square);
  }
  modal::Modes modes;
  modes.frequency_hz = modes.damping_ratio = Eigen::VectorXd::Zero(1);
  modes.shapes = Eigen::MatrixXd::Ones(3 * body.node_count(), 1);
  const Sampler sampler(body, modes, {});
  const auto faces = mesh::facing(body, Eigen::Vector3d::UnitZ()).face;
  const auto surface = sampler.smooth_surface(faces);
  const double reach = surface.sites.position.col(0).maxCoeff();
  ASSERT_LT(reach, 0.052);  // of 0.06: there it falls by 37 degrees
  const Worth worth = [](const Sites& sites) { return Eigen::VectorXd(sites.position.col(0)); };
  const FaceFinder finder(body, surface.faces);
  const auto start = part(surface.sites, {0});
  EXPECT_LE(refined(sampler, start, worth, 0.02, 1e-5, &finder).position(0, 0), reach + 1e-9);
  EXPECT_GT(refined(sampler, start, worth, 0.02, 1e-5).position(0, 0), 0.058);
}

// Two devices do not go to one place of the edge between two patches.
TEST(CandidatesOn, PatchesThatMeetHaveEachPlaceOnce) {
  const Known known;
  const std::vector<std::string> patches{"top", "x_min"};
  const auto places = [&](const Device& device) {
    const Sampler sampler(known.body, known.modes, device);
    return candidates_on(sampler.surface(patches), {}).sites.position;
  };
  const auto at = places({Eigen::Vector3d::UnitZ(), 0.0});
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_GT((at.row(i) - at.row(j)).norm(), 1e-6);
  }
  EXPECT_GT(places({}).rows(), at.rows());  // along two normals an edge is seen twice
}

class GridOf : public ::testing::Test {
 protected:
  Known known_ = with_a_left_patch();
  Sampler sampler_{known_.body, known_.modes, {}};

  Points places_on(const std::vector<std::string>& patches, const Grid& grid) {
    return candidates_on(grid, sampler_, sampler_.surface(patches), {}).sites.position;
  }
};

TEST_F(GridOf, PlacesLieOnTheFacesThatDevicesMayBeOn) {
  const Grid grid{.pitch = {0.05, 0.1}, .columns = 9, .rows = 3};  // x from -0.2 to 0.2
  const auto below = places_on({"bottom"}, grid);
  EXPECT_EQ(below.rows(), 27);
  EXPECT_LT((below.col(2).array() + 0.02).abs().maxCoeff(), 1e-12);
  const auto left = places_on({"left"}, grid);
  EXPECT_EQ(left.rows(), 9);  // with those on its border, at -0.1
  EXPECT_LT(left.col(0).maxCoeff(), -0.1 + 1e-12);
  const auto right = places_on({"top"}, grid);
  EXPECT_EQ(right.rows(), 21);
  EXPECT_GT(right.col(0).minCoeff(), -0.1 - 1e-12);
  EXPECT_EQ(places_on({"left", "top"}, grid).rows(), 27);
  EXPECT_EQ(places_on({"left", "bottom"}, grid).rows(), 27);
}

TEST_F(GridOf, ThatMissesTheseFacesIsRefused) {
  const auto refusal = refusal_of([&] {
    (void)places_on({"x_min"}, {.pitch = {0.05, 0.1}, .columns = 9, .rows = 3});
  });
  EXPECT_NE(refusal.find("lies on the faces that devices may be on"), std::string::npos) << refusal;
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
