#include "simulators/rigs/rig_score.h"

#include <gtest/gtest.h>

namespace chladni::simulators {
namespace {

diagnosis::Cause cause(const std::string& effect, double probability,
                       std::vector<std::string> channels = {}) {
  diagnosis::Cause one;
  one.effect = effect;
  one.probability = probability;
  one.channels = std::move(channels);
  return one;
}

diagnosis::Diagnosis telling(std::vector<diagnosis::Cause> causes) {
  diagnosis::Diagnosis told;
  told.best.causes = std::move(causes);
  return told;
}

RealRigCase hiding(std::vector<HiddenEffect> truth) {
  RealRigCase rig;
  rig.body = real_body("table");
  rig.truth = std::move(truth);
  return rig;
}

const HiddenEffect kSign{"sensor_sign", {}, {}, {"s3"}};
const HiddenEffect kMass{"point_mass", {{"mass", 0.2}}, Eigen::Vector2d(0.1, 0.1), {}};

TEST(RigScore, FalseNamesCountWhereNothingIsHidden) {
  const auto rig = hiding({});
  EXPECT_EQ(scored(rig, telling({})).verdict, RigVerdict::right);
  EXPECT_EQ(scored(rig, telling({cause("density", 0.8)})).verdict, RigVerdict::right);
  EXPECT_EQ(scored(rig, telling({cause("density", 0.95)})).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, AsksForTheChannels) {
  const auto rig = hiding({kSign});
  EXPECT_EQ(scored(rig, telling({cause("sensor_sign", 0.99, {"s3"})})).verdict, RigVerdict::right);
  EXPECT_EQ(scored(rig, telling({cause("sensor_sign", 0.99, {"s4"})})).verdict,
            RigVerdict::wrong_sure);
  EXPECT_EQ(scored(rig, telling({cause("sensor_sign", 0.3, {"s3"})})).verdict, RigVerdict::missed);
  EXPECT_EQ(
      scored(rig, telling({cause("sensor_sign", 0.99, {"s3"}), cause("density", 0.95)})).verdict,
      RigVerdict::phantom);
}

TEST(RigScore, HalfOfTwoIsNotRight) {
  const auto rig = hiding({kSign, kMass});
  const auto sign = cause("sensor_sign", 0.99, {"s3"});
  EXPECT_EQ(scored(rig, telling({sign})).verdict, RigVerdict::half);
  EXPECT_EQ(scored(rig, telling({sign, cause("point_mass", 0.9)})).verdict, RigVerdict::right);
}

TEST(RigScore, MeasuresPlaceAndSizeOfKin) {
  const auto rig = hiding({kMass});
  auto mass = cause("point_mass", 0.99);
  mass.place = Eigen::Vector2d(0.1, 0.13);
  mass.parameters = {{"mass", "kg", 0.23, 0.02, diagnosis::Parameter::Role::strength}};
  const auto score = scored(rig, telling({mass}));
  EXPECT_NEAR(score.place_error(), 0.03, 1e-12);
  EXPECT_NEAR(score.worst_z(), 1.5, 1e-12);
  mass.effect = "mass_with_inertia";
  EXPECT_EQ(scored(rig, telling({mass})).verdict, RigVerdict::right);
  mass.place = Eigen::Vector2d(-0.2, -0.1);
  EXPECT_EQ(scored(rig, telling({mass})).verdict, RigVerdict::wrong_sure);
}

// A mass that is missing elsewhere is another cause.
TEST(RigScore, AsksForThePlaceAndTheSign) {
  const auto rig = hiding({kMass});
  auto mass = cause("point_mass", 0.99);
  mass.place = Eigen::Vector2d(0.1, 0.13);
  mass.parameters = {{"mass", "kg", 0.23, 0.02, diagnosis::Parameter::Role::strength}};
  EXPECT_EQ(scored(rig, telling({mass})).verdict, RigVerdict::right);
  mass.place = Eigen::Vector2d(-0.2, -0.1);
  EXPECT_EQ(scored(rig, telling({mass})).verdict, RigVerdict::wrong_sure);
  mass.place = Eigen::Vector2d(0.1, 0.13);
  mass.parameters.front().value = -0.23;
  EXPECT_EQ(scored(rig, telling({mass})).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, TakesScalesForOneWithoutScale) {
  auto rig = hiding({{"density", {{"relative", 0.1}}, {}, {}}});
  const auto told = telling({cause("youngs_modulus", 0.99)});
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::wrong_sure);
  rig.scaled = false;
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::right);
}

TEST(RigScore, TellsScalesAsAClassWhereTheTruthIsAmongThem) {
  const auto rig = hiding({{"density", {{"relative", 0.1}}, {}, {}}});
  auto told = telling({cause("thickness", 0.45)});
  told.best.probability = 0.45;
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::missed);
  auto rival = telling({cause("density", 0.4)}).best;
  rival.probability = 0.4;
  told.rivals = {rival};
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::as_class);
  told.rivals.front().causes.front().effect = "point_mass";
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::missed);
  told.rivals = {rival};
  told.best.causes.front().probability = 0.95;
  EXPECT_EQ(scored(rig, told).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, CountsSizesAndPlacesWithinTwoDeviations) {
  using Role = diagnosis::Parameter::Role;
  auto mass = cause("point_mass", 0.99);
  mass.place = Eigen::Vector2d(0.1, 0.13);
  mass.parameters = {{"mass", "kg", 0.23, 0.02, Role::strength},
                     {"u", "m", 0.1, 0.01, Role::place_u},
                     {"v", "m", 0.13, 0.01, Role::place_v}};
  const auto score = scored(hiding({kMass}), telling({mass}));
  EXPECT_EQ(score.sizes().count, 1);
  EXPECT_EQ(score.sizes().good, 1);
  EXPECT_EQ(score.places().count, 2);
  EXPECT_EQ(score.places().good, 1);
}

TEST(RigScore, DoesNotBlameTheStringThatIsThere) {
  auto rig = hiding({});
  rig.present = {{"resonator", {{"frequency", 300.0}}, {}, {}}};
  auto string = cause("resonator", 0.99);
  string.parameters = {{"frequency", "Hz", 305.0, 2.0, diagnosis::Parameter::Role::strength}};
  EXPECT_EQ(scored(rig, telling({string})).verdict, RigVerdict::right);
  string.parameters.front().value = 400.0;
  EXPECT_EQ(scored(rig, telling({string})).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, DoesNotBlameAGainThatIsThere) {
  auto rig = hiding({});
  rig.present = {{"actuator_gain", {{"relative", -0.137}}, {}, {"f3"}}};
  auto gain = cause("actuator_gain", 0.99);
  gain.channels = {"f3"};
  gain.parameters = {{"relative", "", -0.146, 0.02, diagnosis::Parameter::Role::strength}};
  EXPECT_EQ(scored(rig, telling({gain})).verdict, RigVerdict::right);
  gain.parameters.front().value = -0.22;
  EXPECT_EQ(scored(rig, telling({gain})).verdict, RigVerdict::wrong_sure);
  gain.parameters.front().value = -0.146;
  gain.channels = {"f2"};
  EXPECT_EQ(scored(rig, telling({gain})).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, DoesNotBlameAPlaceThatIsThere) {
  auto rig = hiding({});
  rig.present = {{"sensor_position", {{"u", 1e-3}, {"v", -7e-3}}, {}, {"s4"}}};
  auto moved = cause("sensor_position", 0.99);
  moved.channels = {"s4"};
  moved.parameters = {{"u", "m", 0.0, 2e-3, diagnosis::Parameter::Role::offset},
                      {"v", "m", -7.5e-3, 2e-3, diagnosis::Parameter::Role::offset}};
  EXPECT_EQ(scored(rig, telling({moved})).verdict, RigVerdict::right);
  moved.parameters.back().value = 7.5e-3;
  EXPECT_EQ(scored(rig, telling({moved})).verdict, RigVerdict::wrong_sure);
}

TEST(RigScore, ExpectsNoNameForKindsOutside) {
  auto rig = hiding({{"line_crack", {}, {}, {}}});
  rig.outside = true;
  EXPECT_EQ(scored(rig, telling({})).verdict, RigVerdict::right);
  EXPECT_EQ(scored(rig, telling({cause("point_mass", 0.95)})).verdict, RigVerdict::wrong_sure);
}

}  // namespace
}  // namespace chladni::simulators
