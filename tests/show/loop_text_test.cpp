// What is not known of a loop that is unstable is told as such.
#include <gtest/gtest.h>

#include <limits>

#include "show/observer.h"

namespace chladni::show {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool is_null(const io::Json& json) { return std::holds_alternative<std::monostate>(json.value()); }

// As a reader of the file sees it.
io::Json left_of(const steps::LoopTrial& trial) {
  return io::parse_json(io::text(loop_json(trial)));
}

steps::LoopTrial trial_of(int draws, int stable_draws) {
  steps::LoopTrial trial;
  trial.points = {"tip"};
  trial.open_rms = {1e-6};
  trial.draws = draws;
  for (auto* one : {&trial.on_sensors, &trial.on_estimate}) {
    one->stable = true;
    one->rms = {5e-7};
    one->modulus_margin = 0.25;
    one->stable_draws = stable_draws;
    one->worst_margin = stable_draws == draws && draws > 0 ? 0.125 : 0.0;
    if (draws == 0) continue;
    one->median_rms = {6e-7};
    one->worst_rms = {stable_draws == draws ? 7e-7 : kInfinite};
  }
  return trial;
}

TEST(LoopText, AnUnstableLoopHasNoMargin) {
  auto trial = trial_of(20, 20);
  trial.on_sensors.stable = false;
  trial.on_sensors.modulus_margin = 0.0;
  const auto json = left_of(trial);
  EXPECT_TRUE(is_null(json.at("on_sensors").at("modulus_margin")));
  EXPECT_EQ(json.at("on_estimate").at("modulus_margin").number(), 0.25);
}

TEST(LoopText, AWorstMarginIsOfModelsThatAreDrawnAndStable) {
  const auto worst = [](const steps::LoopTrial& trial) {
    return left_of(trial).at("on_estimate").at("worst_modulus_margin");
  };
  EXPECT_EQ(worst(trial_of(20, 20)).number(), 0.125);
  EXPECT_NE(loop_text(trial_of(20, 20)).find("0.12"), std::string::npos);
  for (const auto& trial : {trial_of(0, 0), trial_of(20, 19)}) {
    EXPECT_TRUE(is_null(worst(trial)));
    EXPECT_EQ(loop_text(trial).find("0.00"), std::string::npos) << loop_text(trial);
  }
  const auto json = left_of(trial_of(20, 19)).at("on_estimate");
  EXPECT_TRUE(is_null(json.at("worst_rms_m").array()[0])) << "one of them drifts";
  EXPECT_NE(loop_text(trial_of(20, 19)).find("drifts"), std::string::npos);
}

}  // namespace
}  // namespace chladni::show
