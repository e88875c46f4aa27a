#include "simulators/hidden/hidden_score.h"

#include <gtest/gtest.h>

namespace chladni::simulators {
namespace {

using diagnosis::Verdict;

HiddenCase mass_hidden() {
  HiddenCase hidden;
  hidden.truth = {{"point_mass", {{"mass", 0.2}}, Eigen::Vector2d(0.1, 0.0), {}}};
  return hidden;
}

diagnosis::Diagnosis called(Verdict verdict, const std::string& effect) {
  diagnosis::Diagnosis told;
  told.verdict = verdict;
  diagnosis::Cause cause;
  cause.effect = effect;
  cause.probability = 0.99;
  cause.place = Eigen::Vector2d(0.1, 0.003);
  cause.parameters = {{"mass", "kg", 0.21, 0.005}, {"u", "m", 0.1, 1e-3}, {"v", "m", 0.003, 1e-3}};
  told.best.causes = {cause};
  return told;
}

TEST(HiddenScore, MeasuresPlaceAndSize) {
  const auto score = scored(mass_hidden(), called(Verdict::named, "point_mass"));
  EXPECT_EQ(score.outcome, Outcome::right);
  EXPECT_FALSE(score.confidently_wrong());
  EXPECT_NEAR(score.effects[0].place_error, 3e-3, 1e-12);
  EXPECT_NEAR(score.effects[0].sizes[0].z(), 2.0, 1e-9);
  EXPECT_NEAR(score.effects[0].sizes[0].relative_error(), 0.05, 1e-9);
}

TEST(HiddenScore, TellsMissesApart) {
  EXPECT_EQ(scored(mass_hidden(), called(Verdict::named, "resonator")).outcome, Outcome::wrong);
  EXPECT_TRUE(scored(mass_hidden(), called(Verdict::named, "resonator")).confidently_wrong());
  auto nothing = called(Verdict::no_discrepancy, "point_mass");
  nothing.best.causes.clear();
  EXPECT_EQ(scored(mass_hidden(), nothing).outcome, Outcome::missed);
  EXPECT_EQ(scored({}, nothing).outcome, Outcome::right);
  EXPECT_EQ(scored({}, called(Verdict::named, "point_mass")).outcome, Outcome::wrong);
  auto unsure = called(Verdict::ambiguous, "resonator");
  EXPECT_EQ(scored(mass_hidden(), unsure).outcome, Outcome::wrong);
  unsure.rivals = {called(Verdict::named, "point_mass").best};
  EXPECT_EQ(scored(mass_hidden(), unsure).outcome, Outcome::among);
  auto two = mass_hidden();
  two.truth.push_back({"sensor_gain", {}, {}, {"s2"}});
  EXPECT_EQ(scored(two, called(Verdict::named, "point_mass")).outcome, Outcome::half);
}

TEST(HiddenScore, WantsWhatTheCatalogueLacksLeftOpen) {
  HiddenCase hidden;
  hidden.outside = true;
  hidden.truth = {{"line_crack", {}, {}, {}}};
  EXPECT_EQ(scored(hidden, called(Verdict::partial, "ground_spring")).outcome, Outcome::right);
  EXPECT_EQ(scored(hidden, called(Verdict::named, "ground_spring")).outcome, Outcome::wrong);
  EXPECT_TRUE(scored(hidden, called(Verdict::named, "ground_spring")).confidently_wrong());
}

// What METHODS counts is the probability, not the verdict.
TEST(HiddenScore, CountsASureWrongNameUnderAnyVerdict) {
  HiddenCase hidden;
  hidden.outside = true;
  hidden.truth = {{"line_crack", {}, {}, {}}};
  auto told = called(Verdict::partial, "ground_spring");
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::right);
  EXPECT_TRUE(scored(hidden, told).confidently_wrong());
  told.best.causes[0].probability = 0.9;
  EXPECT_FALSE(scored(hidden, told).confidently_wrong());
  EXPECT_EQ(scored(hidden, told).surest_phantom, 0.9);
}

TEST(HiddenScore, TellsAPhantomFromWhatIsOpen) {
  EXPECT_EQ(scored(mass_hidden(), called(Verdict::partial, "point_mass")).outcome, Outcome::open);
  auto two = called(Verdict::named, "point_mass");
  two.best.causes.push_back(called(Verdict::named, "ground_damper").best.causes[0]);
  two.best.causes[1].probability = 0.8;
  const auto score = scored(mass_hidden(), two);
  EXPECT_EQ(score.outcome, Outcome::phantom);
  EXPECT_EQ(score.surest_phantom, 0.8);
  EXPECT_EQ(score.phantoms.substr(0, 19), "ground_damper mass=");
  two.best.causes[1].effect = "point_mass";  // once in the truth, told twice
  EXPECT_EQ(scored(mass_hidden(), two).outcome, Outcome::phantom);
  EXPECT_EQ(scored(mass_hidden(), called(Verdict::ambiguous, "point_mass")).outcome,
            Outcome::among);
}

// Crosstalk from the wrong side is another crosstalk; a swap has no sides.
TEST(HiddenScore, LooksAtWhichChannelSpoilsWhich) {
  HiddenCase hidden;
  hidden.truth = {{"actuator_crosstalk", {{"share", 0.1}}, {}, {"a1", "a3"}}};
  auto told = called(Verdict::named, "actuator_crosstalk");
  told.best.causes[0].channels = {"a1", "a3"};
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::right);
  told.best.causes[0].channels = {"a3", "a1"};
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::wrong);
}

// A twin is none where the data tell it from the truth.
TEST(HiddenScore, AcceptsATwinOnlyWhereNobodyCanTell) {
  HiddenOptions options;
  options.lines = 40;
  options.degree = 8;
  options.severity = 0.0;
  auto hidden = hidden_case({"sensor_delay"}, 3, options);
  auto told = called(Verdict::named, "sensor_low_pass");
  told.best.causes[0].channels = hidden.truth[0].channels;
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::twin);
  EXPECT_FALSE(scored(hidden, told).confidently_wrong());
  told.best.causes[0].channels = {"s_other"};
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::wrong);
  options.severity = 1.0;
  hidden = hidden_case({"sensor_delay"}, 3, options);
  told.best.causes[0].channels = hidden.truth[0].channels;
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::wrong);
  EXPECT_TRUE(scored(hidden, told).confidently_wrong());
}

// Another channel is another name.
TEST(HiddenScore, LooksAtTheChannel) {
  HiddenCase hidden;
  hidden.truth = {{"swapped_sensors", {}, {}, {"s1", "s3"}}};
  auto told = called(Verdict::named, "swapped_sensors");
  told.best.causes[0].channels = {"s3", "s1"};
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::right);
  told.best.causes[0].channels = {"s3", "s2"};
  EXPECT_EQ(scored(hidden, told).outcome, Outcome::wrong);
}

}  // namespace
}  // namespace chladni::simulators
