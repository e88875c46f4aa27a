// models/oat/with_hidden_effect by the path that ships: tetrahedra, structure, diagnosis, extended
// study. The truth is that of the simulator that made its responses, a Mindlin plate by Ritz.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "app/command.h"
#include "rotation/turn.h"
#include "show/diagnosis.h"
#include "steps/diagnosis.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

// As docs/reference/diagnosis.md says.
constexpr double kMass = 29.95e-3, kFrequency = 247.6, kDampingRatio = 0.0293;
const Eigen::Vector2d kPlace(124.6e-3, 114.7e-3);

const diagnosis::CauseParameter& parameter(const diagnosis::Cause& cause, const std::string& name) {
  return *std::ranges::find(cause.parameters, name, &diagnosis::CauseParameter::name);
}

void expect_near(const diagnosis::Cause& cause, const std::string& name, double truth,
                 double within) {
  const auto& told = parameter(cause, name);
  EXPECT_GT(told.std, 0.0) << name;
  EXPECT_NEAR(told.value, truth, std::min(3.0 * told.std, within)) << name;
}

TEST(HiddenStory, IsNamedWithItsPlaceItsMassAndWhatItGains) {
  EVERY_FOURTH_LANDING();
  const auto file =
      std::filesystem::path(CHLADNI_SOURCE_DIR) / "models/oat/with_hidden_effect/study.toml";
  const TestFolder folder("hidden_story");
  const study::Study study = study::read_study(file);
  QuietRun quiet(study, folder.path());
  const auto one = steps::diagnosed(study, quiet.run());
  EXPECT_EQ(one.result.verdict, diagnosis::Verdict::named) << show::verdict_text(one.result);
  ASSERT_EQ(one.result.best.causes.size(), 1U) << show::verdict_text(one.result);
  const auto& cause = one.result.best.causes.front();
  ASSERT_EQ(cause.effect, "resonator");
  EXPECT_GT(cause.probability, 0.9);
  expect_near(cause, "mass", kMass, 1.5e-3);
  expect_near(cause, "frequency", kFrequency, 0.5);
  expect_near(cause, "damping_ratio", kDampingRatio, 2e-3);
  expect_near(cause, "u", kPlace.x(), 2e-3);
  expect_near(cause, "v", kPlace.y(), 2e-3);
  EXPECT_LT((*cause.place - kPlace).norm(), 2e-3);
  // The extended study, solved in full, on what the diagnosis saw and on s4, which it did not.
  const auto& gain = one.gain;
  ASSERT_TRUE(one.extended.has_value());
  EXPECT_TRUE(gain.pays);
  EXPECT_EQ(gain.held_out, std::vector<std::string>{"s4"});
  EXPECT_LT(gain.fit_after, 0.65 * gain.fit_before);
  EXPECT_LT(gain.held_out_after, 0.75 * gain.held_out_before);
  EXPECT_LT(gain.fit_after, 2.0 * gain.noise_floor);
  EXPECT_LT(gain.held_out_after, 2.0 * gain.held_out_noise);
  EXPECT_GT(gain.held_out_before, 2.0 * gain.held_out_noise);
}

}  // namespace
}  // namespace chladni::app
