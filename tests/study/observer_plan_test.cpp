// [observer] of a study: what is read and what is refused.
#include "study/observer_plan.h"

#include <gtest/gtest.h>

#include "study/schemas.h"
#include "tests/refusal.h"
#include "tests/study/plate_text.h"

namespace chladni::study {
namespace {

Study study_with(const std::string& tables) {
  return parse_study(kPlateText + std::string(R"([[sensor]]
name = "s1"
at = ["0 mm", "0 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["0 mm", "0 mm"]
direction = "z"
)") + tables,
                     "plate.toml");
}

const std::string kWhole = R"([observer]
noise = "2 nm"
sample_rate = "10 kHz"
[[observer.point]]
name = "tool"
at = ["10 mm", "20 mm"]
direction = "z"
[[observer.disturbance]]
name = "amplifier"
kind = "actuators"
density = "4 mN^2/Hz"
[[observer.disturbance]]
name = "floor"
kind = "floor"
rms = "1 mm/s^2"
band = ["1 Hz", "80 Hz"]
[[observer.disturbance]]
name = "hose"
kind = "force"
at = ["100 mm", "0 mm"]
rms = "0.2 N"
drift_time = "10 s"
[observer.loop]
actuators = ["a1"]
bandwidth = "20 Hz"
)";

TEST(ObserverPlan, IsReadInSiUnits) {
  const auto plan = *study_with(kWhole).observer;
  EXPECT_DOUBLE_EQ(plan.noise, 2e-9);
  EXPECT_DOUBLE_EQ(plan.sample_rate_hz, 1e4);
  ASSERT_EQ(plan.points.size(), 1U);
  EXPECT_EQ(plan.points[0].at.point, Eigen::Vector3d(0.01, 0.02, 0.0));
  ASSERT_EQ(plan.disturbances.size(), 3U);
  EXPECT_DOUBLE_EQ(plan.disturbances[0].density, 4e-6);
  EXPECT_DOUBLE_EQ(plan.disturbances[1].rms, 1e-3);
  EXPECT_EQ(plan.disturbances[1].high_hz, 80.0);
  EXPECT_EQ(plan.disturbances[2].drift_time, 10.0);
  EXPECT_EQ(plan.loop->bandwidth_hz, 20.0);
}

TEST(ObserverPlan, RefusesWhatCannotBeMeant) {
  const auto refused = [](const std::string& keys) {
    return refusal_of([&] { return study_with("[observer]\n" + keys); });
  };
  const auto disturbed = [&](const std::string& keys) {
    return refused("[[observer.disturbance]]\nname = \"d\"\n" + keys);
  };
  const auto says = [](const std::string& found, const std::string& part) {
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  says(refused("noise = \"2 nm\"\n"), "disturbance");
  says(refused("noise = \"2 N\"\n"), "observer.noise");
  says(disturbed("kind = \"actuators\"\n"), "either rms = \"0.1 N\"");
  says(disturbed("kind = \"floor\"\nrms = \"1 N\"\n"), "rms");
  says(disturbed("kind = \"wind\"\nrms = \"1 N\"\n"), "kind");
  says(disturbed("kind = \"force\"\nrms = \"1 N\"\n"), "at");
  says(disturbed("kind = \"floor\"\nrms = \"1 m/s^2\"\nat = [\"0 mm\", \"0 mm\"]\n"),
       "changes nothing of kind \"floor\"");
  says(disturbed("kind = \"actuators\"\nrms = \"1 N\"\nactuators = [\"a2\"]\n"), "\"a2\"");
  says(disturbed("kind = \"actuators\"\nrms = \"1 N\"\nband = [\"1 Hz\", \"2 Hz\"]\ndrift_time = "
                 "\"1 s\"\n"),
       "a drift has an rms");
  says(disturbed("kind = \"actuators\"\nrms = \"1 N\"\n[observer.loop]\nbandwidth = \"2 Hz\"\n"),
       "those that it drives");
}

TEST(ObserverLayoutPlan, IsReadInSiUnits) {
  const auto plan = study_with(R"([placement]
choose = { sites = 4, by = "observer" }
[placement.observer]
region = [{ box = { from = ["0 mm", "0 mm"], to = ["50 mm", "40 mm"] } }]
sensors = 1
pairs = 2
effort = "10 nm/N"
suspension = "3 Hz"
)")
                        .placement.value();
  EXPECT_EQ(plan.choose_by, "observer");
  ASSERT_TRUE(plan.observer.has_value());
  EXPECT_EQ(plan.observer->sensors, 1);
  EXPECT_EQ(plan.observer->actuators, 0);
  EXPECT_EQ(plan.observer->pairs, 2);
  EXPECT_DOUBLE_EQ(plan.observer->effort, 1e-8);
  EXPECT_DOUBLE_EQ(plan.observer->suspension_hz, 3.0);
  ASSERT_EQ(plan.observer->region.size(), 1U);
  EXPECT_DOUBLE_EQ(plan.observer->region[0].to.x(), 0.05);
  const auto bare = study_with("[placement]\nchoose = { by = \"observer\" }\n").placement.value();
  ASSERT_TRUE(bare.observer.has_value());
  EXPECT_EQ(bare.observer->sensors, 0);
  EXPECT_FALSE(study_with("[placement]\nmodes = 3\n").placement->observer.has_value());
}

TEST(ObserverLayoutPlan, RefusesWhatSaysNothing) {
  const auto refused = [](const std::string& lines, const std::string& part) {
    const auto message =
        refusal_of([&] { return study_with("[placement]\n[placement.observer]\n" + lines); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused("region = []\n", "placement.observer.region is empty");
  refused("region = 3\n", "placement.observer.region is");
  refused("actuators = 1\n", "the motion that a force of 1 N is worth");
  refused("effort = \"1 N\"\n", "m/N");
  refused("sensors = -1\n", "placement.observer.sensors");
  refused("motors = 1\n", "motors");
}

}  // namespace
}  // namespace chladni::study
