// The card that opens a report tells what the diagnosis found, and nothing that it did not.
#include "show/diagnosis/verdict_card.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "show/diagnosis.h"

namespace chladni::show {
namespace {

steps::Diagnosed named() {
  steps::Diagnosed one;
  one.result.verdict = diagnosis::Verdict::named;
  diagnosis::Cause cause;
  cause.effect = "point_mass";
  cause.place = Eigen::Vector2d(0.1, -0.2);
  cause.probability = 0.98;
  cause.parameters = {{"mass", "kg", 0.25, 0.001}};
  one.result.best.causes = {cause};
  one.structure.surface.origin = Eigen::Vector3d(0.0, 0.0, 0.02);
  one.gain.fit_before = 0.05;
  one.gain.fit_after = one.gain.fit_extended = 0.011;
  one.gain.noise_floor = 0.01;
  one.gain.from = steps::GainFrom::extended_study;
  one.gain.pays = true;
  one.extended.emplace();
  return one;
}

bool says(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(
      lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

TEST(VerdictCard, TellsTheCauseTheErrorsAndTheNextStep) {
  const auto card = verdict_card(named());
  EXPECT_EQ(card.tone, io::Note::Tone::good);
  EXPECT_TRUE(says(card.lines, "point_mass")) << "the cause";
  EXPECT_TRUE(says(card.lines, "probability 0.980"));
  ASSERT_EQ(card.figures.size(), 3U);
  EXPECT_EQ(card.figures[0].value, "5 %");
  EXPECT_EQ(card.figures[1].value, "1.1 %");
  EXPECT_EQ(card.figures[2].value, "1 %");
  EXPECT_TRUE(says(card.next, "extended.toml"));
}

TEST(VerdictCard, MarksThePlaceOnTheBodyAndTheChannels) {
  auto one = named();
  diagnosis::Cause gain;
  gain.effect = "sensor_gain";
  gain.channels = {"s3"};
  one.result.best.causes.push_back(gain);
  const auto markers = cause_markers(one);
  ASSERT_EQ(markers.size(), 1U);
  EXPECT_EQ(markers[0].kind, "cause");
  EXPECT_LT((markers[0].position - Eigen::Vector3d(0.1, -0.2, 0.02)).norm(), 1e-15);
  EXPECT_LT((markers[0].direction - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_EQ(marked_names(one), (std::vector<std::string>{"point_mass", "s3"}));
}

TEST(VerdictCard, WarnsWhereTheCauseMakesHeldOutDataWorse) {
  auto one = named();
  one.gain.held_out = {"s4"};
  one.gain.held_out_before = 0.24;
  one.gain.held_out_after = one.gain.held_out_extended = 0.38;
  one.gain.pays = false;
  const auto card = verdict_card(one);
  EXPECT_EQ(card.tone, io::Note::Tone::warning);
  EXPECT_TRUE(says(card.lines, "it is not recommended"));
  EXPECT_FALSE(says(card.next, "extended.toml"));
}

TEST(VerdictCard, PromisesNothingAfterWhereNoCauseWasNamed) {
  auto one = named();
  one.result.verdict = diagnosis::Verdict::unexplained;
  one.result.best.causes.clear();
  one.gain.from = steps::GainFrom::nothing;
  one.result.measure_next = "a sensor at (1, 2) mm";
  const auto card = verdict_card(one);
  EXPECT_EQ(card.tone, io::Note::Tone::warning);
  ASSERT_EQ(card.figures.size(), 2U);
  EXPECT_TRUE(says(card.next, "measure next: a sensor at (1, 2) mm."));
  EXPECT_TRUE(cause_markers(one).empty());
}

// The card says what the terminal says: the two were of different words once.
TEST(VerdictCard, WithoutACauseIsHeadedByTheVerdict) {
  auto one = named();
  one.result.verdict = diagnosis::Verdict::no_discrepancy;
  one.result.best.causes.clear();
  one.gain.from = steps::GainFrom::nothing;
  EXPECT_EQ(verdict_card(one).heading, verdict_text(one.result));
  one.result.constants.emplace_back();
  one.modes.emplace();
  one.result.modes = {{.measured_hz = 100.0, .before_hz = 112.0, .after_hz = 101.0}};
  const auto card = verdict_card(one);
  EXPECT_EQ(card.heading, verdict_text(one.result));
  EXPECT_TRUE(says({card.heading}, "which are calibrated"));
  ASSERT_EQ(card.figures.size(), 2U);
  EXPECT_EQ(card.figures[1].value, "1 %");
  EXPECT_EQ(card.figures[1].label, "frequencies off, calibrated");
  EXPECT_TRUE(says(card.next, "calibrated constants"));
  EXPECT_FALSE(says(card.next, "nothing has to be changed"));
}

TEST(VerdictCard, OfModesTellsHowFarFrequenciesAreOff) {
  auto one = named();
  one.modes.emplace();
  one.result.modes = {{.measured_hz = 100.0, .before_hz = 103.0, .after_hz = 101.0},
                      {.measured_hz = 200.0, .before_hz = 194.0, .after_hz = 198.0},
                      {.measured_hz = 300.0, .before_hz = NAN, .after_hz = NAN}};
  const auto card = verdict_card(one);
  ASSERT_EQ(card.figures.size(), 2U);
  EXPECT_EQ(card.figures[0].value, "3 %");
  EXPECT_EQ(card.figures[1].value, "1 %");
}

}  // namespace
}  // namespace chladni::show
