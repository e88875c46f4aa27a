#include "diagnosis/modes/search/modes_look.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/labelled_rig.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSensor = 2;
const double kGain = std::log(1.4);

// The small plate with a mass, a sensor that reads too much, and errors of all frequencies and
// shapes.
MeasuredModes scattered() {
  State state = state_of(small_plate());
  effect("point_mass").apply(state, small_plate(), 0, Eigen::Vector3d(1.2, 0.21, 0.08));
  effect("sensor_gain").apply(state, small_plate(), kSensor, VectorXd::Constant(1, kGain));
  auto measured = measured_of(modes_of(state), 0.03);
  simulators::Dice dice(3);
  for (double& hz : measured.frequency_hz) hz *= std::exp(0.015 * dice.normal());
  std::ranges::sort(measured.frequency_hz);
  measured.scaled = true;
  return measured;
}

class LooksBeside : public testing::Test {
 protected:
  LooksBeside() : problem_(small_plate(), measured_, Tolerances{}, true) {
    nothing_ = problem_.nothing();
  }
  [[nodiscard]] ModesLook look() const {
    return {problem_, nothing_, levels_to_look_at(problem_, nothing_)};
  }
  MeasuredModes measured_ = scattered();
  ModesProblem problem_;
  ModesFit nothing_;
};

TEST_F(LooksBeside, LevelsOfOneGroupAtATime) {
  ModesFit base = nothing_;
  base.levels = 30.0 * problem_.prior().usual;
  const auto all = levels_to_look_at(problem_, base);
  EXPECT_TRUE((all.front() == base.levels).all());
  std::set<std::vector<Index>> groups;
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_TRUE((all[i] <= base.levels).all());
    EXPECT_TRUE((all[i] >= problem_.prior().usual).all());
    std::vector<Index> lower;
    for (Index c = 0; c < all[i].size(); ++c) {
      if (all[i](c) < base.levels(c)) lower.push_back(c);
    }
    groups.insert(lower);
  }
  std::set<Index> classes;
  std::size_t count = 0;
  for (const auto& group : groups) {
    classes.insert(group.begin(), group.end());
    count += group.size();
  }
  EXPECT_EQ(classes.size(), count) << "a class is in two groups";
  EXPECT_TRUE(classes.contains(static_cast<Index>(ErrorClass::frequency)));
  EXPECT_TRUE(classes.contains(static_cast<Index>(ErrorClass::gain)));
  EXPECT_EQ(all.size(), 1 + 2 * groups.size());
}

TEST_F(LooksBeside, NoOtherLevelsThanThoseThatAreKnownOrUsual) {
  ModesFit base = nothing_;
  base.levels = problem_.prior().usual;
  EXPECT_EQ(levels_to_look_at(problem_, base).size(), 1U);
  const ModesProblem known(small_plate(), measured_, Tolerances{}, false);
  base.levels = 30.0 * known.prior().usual;
  EXPECT_EQ(levels_to_look_at(known, base).size(), 1U);
}

TEST_F(LooksBeside, ASizeThatTheErrorsHideIsNoStart) {
  const auto beside = look();
  const auto& gain = effect("sensor_gain");
  for (const double one : beside({&gain, kSensor, VectorXd::Constant(1, 1e-5)})) {
    EXPECT_EQ(one, HUGE_VAL);
  }
  for (const double one : beside({&gain, kSensor, VectorXd::Constant(1, 1.0)})) {
    EXPECT_TRUE(std::isfinite(one));
  }
}

// The gain's own level is that of all channels where the fit does not know the cause; the best of
// the looks knows better.
TEST_F(LooksBeside, ABadGainIsClearestBesideLessScatterOfGains) {
  const auto beside = look();
  const auto& levels = beside.levels();
  std::size_t best = 0;
  double most = -HUGE_VAL;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto moved =
        beside.moved({&effect("sensor_gain"), kSensor, VectorXd::Constant(1, 0.25)}, i);
    if (moved.log_evidence <= most) continue;
    most = moved.log_evidence;
    best = i;
    EXPECT_NEAR(moved.cause.x(0), kGain, 0.1) << i;
  }
  const auto gain = static_cast<Index>(ErrorClass::gain);
  EXPECT_LT(levels[best](gain), nothing_.levels(gain));
}

// Where levels are known a full fit learns none, and its ln evidence is that of the look but for
// what all causes share. A look stays where a step gains less than Constants::start_fall, so two
// looks differ by twice that at most.
TEST(ModesLook, RanksCausesAsTheFullFitDoesWhereLevelsAreKnown) {
  State state = state_of(small_plate());
  effect("sensor_gain").apply(state, small_plate(), kSensor, VectorXd::Constant(1, 0.1));
  auto measured = measured_of(modes_of(state), 0.02);
  measured.scaled = true;
  const ModesProblem known(small_plate(), measured, Tolerances{}, false);
  const auto nothing = known.nothing();
  const ModesLook look(known, nothing, levels_to_look_at(known, nothing));
  const auto difference = [&](const char* name, Index option, const VectorXd& x) {
    ModesFit start = nothing;
    start.causes.push_back({&effect(name), option, x});
    const auto fit = known.fitted(start);
    return look.moved(fit.causes.front(), 0).log_evidence - fit.log_evidence;
  };
  const double of_gain = difference("sensor_gain", kSensor, VectorXd::Constant(1, 0.05));
  EXPECT_NEAR(difference("sensor_gain", 0, VectorXd::Constant(1, 0.05)), of_gain,
              2.0 * kConstants.start_fall);
  EXPECT_NEAR(difference("youngs_modulus", 0, VectorXd::Constant(1, 0.02)), of_gain,
              2.0 * kConstants.start_fall);
  EXPECT_NEAR(difference("density", 0, VectorXd::Constant(1, 0.02)), of_gain,
              2.0 * kConstants.start_fall);
  EXPECT_NEAR(difference("thickness", 0, VectorXd::Constant(1, 0.02)), of_gain,
              2.0 * kConstants.start_fall);
}

// What takes more mass than there is has no evidence, not that of the fit that it began with.
TEST(ModesProblem, GivesNoEvidenceToWhatNoBodyIsLike) {
  const auto measured = measured_of(modes_of(state_of(small_plate())), 0.02);
  const ModesProblem known(small_plate(), measured, Tolerances{}, false);
  ModesFit start = known.nothing();
  ASSERT_TRUE(std::isfinite(start.log_evidence));
  const VectorXd taken{{-2.0 * small_plate().mass_kg, 0.0, 0.0}};
  start.causes.push_back({&effect("point_mass"), 0, taken});
  EXPECT_FALSE(std::isfinite(known.fitted(start).log_evidence));
}

// What the modes of a strip with something hidden say of one cause.
Diagnosis told_of_strip(const simulators::RealRigCase& rig) {
  DiagnosisOptions options;
  options.most_causes = 1;
  return diagnosed(believed("strip"), rig.modes, options);
}

// A strip among whose five sensors one reads half of what it should, whose frequencies are 1.4 %
// and shapes 7 % off: the truth has neither the model nor the errors of this room. The cause has 14
// more ln evidence than scatter of all gains, and was not looked at.
TEST(DiagnosedRig, NamesTheBadGainOfFiveSensors) {
  for (const unsigned seed : {1U, 4U}) {
    const auto rig = simulators::real_rig_case("strip", "sensor_gain", seed);
    const auto found = told_of_strip(rig);
    ASSERT_EQ(found.best.causes.size(), 1U) << seed;
    const auto& cause = found.best.causes.front();
    EXPECT_EQ(cause.effect, "sensor_gain") << seed;
    EXPECT_EQ(cause.channels, rig.truth.front().channels) << seed;
    EXPECT_GT(cause.log_evidence_gain, 6.5) << seed;  // from there on it outweighs none
    const auto& size = cause.parameters.front();
    EXPECT_NEAR(size.value, rig.truth.front().size.at("relative"), 3.0 * size.std) << seed;
  }
}

// Exchanged records of five sensors take two modes of seven from their partners, and a third has a
// wrong one. The exchange gives them back: it has 125 more ln evidence, and was sought with the
// pairs of no exchange alone.
TEST(DiagnosedRig, NamesExchangedSensorsWhereModesLostTheirPartners) {
  for (const unsigned seed : {1900U, 5U}) {
    const auto rig = simulators::real_rig_case("strip", "swapped_sensors", seed);
    const auto found = told_of_strip(rig);
    ASSERT_EQ(found.best.causes.size(), 1U) << seed;
    EXPECT_EQ(found.best.causes.front().effect, "swapped_sensors") << seed;
    EXPECT_GT(found.best.causes.front().probability, 0.9) << seed;
  }
}

}  // namespace
}  // namespace chladni::diagnosis
