// A designed hammer test on a rig that is stepped sample by sample.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "identification/hammer_design.h"
#include "identification/modal_fit.h"
#include "recordings/hammer.h"
#include "recordings/virtual_experiment.h"
#include "tests/refusal.h"

namespace chladni::identification {
namespace {

// One sensor near the end of a bar whose modes are cosines; points along it.
DesignModel bar() {
  DesignModel bar{.model = {}, .kinds = {modal::FrfKind::receptance}, .largest = {}};
  auto& model = bar.model;
  model.frequency_hz = Eigen::Vector3d(20.0, 40.0, 60.0);
  model.damping_ratio = Eigen::Vector3d(0.02, 0.015, 0.01);
  model.output_shapes.resize(1, 3);
  for (int k = 0; k < 3; ++k) {
    model.output_shapes(0, k) = std::cos((k + 1) * std::numbers::pi * 0.05);
  }
  model.input_shapes.setZero(3, 0);
  model.residual.setZero(1, 0);
  bar.largest = Eigen::Vector3d::Ones();
  return bar;
}

Eigen::MatrixXd points() {
  Eigen::MatrixXd shapes(81, 3);
  for (int i = 0; i < 81; ++i) {
    for (int k = 0; k < 3; ++k) shapes(i, k) = std::cos((k + 1) * std::numbers::pi * i / 80.0);
  }
  return shapes;
}

HammerPlan plan() {
  return {.sample_time_s = 1.0 / 4096.0,
          .low_hz = 5.0,
          .high_hz = 100.0,
          .sensor_noise = Eigen::VectorXd::Constant(1, 4e-5),
          .force_limit_n = 20.0,
          .damping_std = 0.02};
}

TEST(HammerDesign, HitsWhereEveryModeMoves) {
  const auto design = hammer_design(bar(), points(), plan());
  ASSERT_FALSE(design.points.empty());
  for (const auto& mode : design.modes) {
    EXPECT_TRUE(mode.reached) << mode.why;
    EXPECT_GT(mode.drive, 0.5);
    EXPECT_LE(mode.damping_std, 0.02);
  }
}

// At no single point of these do both modes move: it takes two.
TEST(HammerDesign, TakesTwoPointsWhereOneDoesNotMoveAll) {
  auto shapes = points();
  shapes.col(2).head(40).setZero();
  shapes.col(0).tail(41).setZero();
  const auto design = hammer_design(bar(), shapes, plan());
  EXPECT_GE(design.points.size(), 2U);
  for (const auto& mode : design.modes) EXPECT_GT(mode.drive, 0.5);
}

TEST(HammerDesign, ChoosesTheBestPairOfAll) {
  auto shapes = points();
  shapes.col(2).head(40).setZero();
  shapes.col(0).tail(41).setZero();
  auto wanted = plan();
  wanted.sensor_noise *= 4.0;  // so that blows, not their least number, decide
  const auto design = hammer_design(bar(), shapes, wanted);
  const auto most = static_cast<double>(design.hits) * static_cast<double>(design.points.size());
  // Every pair, by the same rule: no pair needs less than half as many blows.
  double best = 1e300;
  for (Eigen::Index a = 0; a < 81; a += 4) {
    for (Eigen::Index b = 40; b < 81; b += 4) {
      const Eigen::MatrixXd two = shapes({a, b}, Eigen::all);
      const auto pair = hammer_design(bar(), two, wanted);
      bool all = true;
      for (const auto& mode : pair.modes) all = all && mode.reached;
      if (all) best = std::min(best, static_cast<double>(pair.hits * std::ssize(pair.points)));
    }
  }
  EXPECT_LE(most, 1.1 * best);
}

TEST(HammerDesign, RecordsUntilTheSlowestModeRests) {
  const auto design = hammer_design(bar(), points(), plan());
  // 20 Hz, 2 %: decays by 2.51 /s; to 1 % in 1.83 s.
  EXPECT_NEAR(design.record_s, std::log(100.0) / (2.0 * std::numbers::pi * 0.4), 1e-3);
  EXPECT_EQ(design.exponential_s, 0.0);
  EXPECT_NEAR(design.fall_db, 10.0, 0.1);
  auto shorter = plan();
  shorter.longest_record_s = 1.0;
  const auto windowed = hammer_design(bar(), points(), shorter);
  EXPECT_NEAR(windowed.record_s, 1.0, 1e-3);
  const double decay = 2.0 * std::numbers::pi * 0.4 + 1.0 / windowed.exponential_s;
  EXPECT_NEAR(std::exp(-decay), 0.01, 1e-4);
}

// A record that ends within a sample or two of rest is rounded up to rest: it needs no window.
TEST(HammerDesign, TakesNoWindowWhereTheRecordIsRoundedUpToRest) {
  const double rest = std::log(100.0) / (2.0 * std::numbers::pi * 0.4);
  for (const double short_of_it : {1e-9, 1e-6, 1e-4}) {
    auto wanted = plan();
    wanted.longest_record_s = rest - short_of_it;
    const auto design = hammer_design(bar(), points(), wanted);
    EXPECT_GE(design.record_s, wanted.longest_record_s);
    EXPECT_EQ(design.exponential_s > 0.0, design.record_s < rest) << short_of_it;
    EXPECT_GE(design.exponential_s, 0.0) << short_of_it;
    EXPECT_EQ(design.notes.empty(), design.exponential_s == 0.0) << short_of_it;
  }
}

// The blows are given to the stepped rig, and the estimate is fitted.
TEST(HammerDesign, TheScatterIsTheExpectedDeviation) {
  const auto wanted = plan();
  const auto design = hammer_design(bar(), points(), wanted);
  auto model = bar().model;
  model.input_shapes = points()(design.points, Eigen::all).transpose();
  model.residual.setZero(1, std::ssize(design.points));
  recordings::VirtualRig rig;
  rig.plant = recordings::plant(model);
  rig.outputs.emplace_back().name = "y";
  for (std::size_t j = 0; j < design.points.size(); ++j) {
    rig.inputs.emplace_back().name = "u" + std::to_string(j);
  }
  rig.sample_time_s = wanted.sample_time_s;
  recordings::TimeData exact{.outputs = rig.outputs,
                             .inputs = rig.inputs,
                             .references = {},
                             .sample_time_s = rig.sample_time_s,
                             .period = 0,
                             .records = {}};
  Draw quiet(1);
  for (std::size_t j = 0; j < design.points.size(); ++j) {
    Eigen::MatrixXd blow = Eigen::MatrixXd::Zero(design.samples, std::ssize(design.points));
    for (Eigen::Index n = 0; static_cast<double>(n) * rig.sample_time_s < design.pulse_s; ++n) {
      blow(n, static_cast<Eigen::Index>(j)) =
          design.peak_n *
          std::sin(std::numbers::pi * static_cast<double>(n) * rig.sample_time_s / design.pulse_s);
    }
    auto record = recorded(rig, blow, quiet);
    record.experiment = static_cast<int>(j);
    for (Eigen::Index h = 0; h < design.hits; ++h) exact.records.push_back(record);
  }
  constexpr int kSeeds = 120;
  Eigen::Matrix3Xd ratio(3, kSeeds);
  for (int seed = 0; seed < kSeeds; ++seed) {
    auto data = exact;
    Draw draw(static_cast<unsigned>(seed));
    for (auto& record : data.records) {
      for (auto& value : record.outputs.reshaped()) {
        value += wanted.sensor_noise(0) * draw.normal();
      }
    }
    auto set = hammer_estimate(data, {.low_hz = wanted.low_hz, .high_hz = wanted.high_hz}).h1;
    ratio.col(seed) = modal_fit(fit_data(set), start_at(model), {.residual = true, .delay = true})
                          .model.damping_ratio;
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto& expected = design.modes[static_cast<std::size_t>(k)];
    const double mean = ratio.row(k).mean();
    const double scatter = std::sqrt((ratio.row(k).array() - mean).square().mean());
    EXPECT_NEAR(scatter / (expected.damping_std * expected.damping_ratio), 1.0, 0.3) << k;
  }
}

TEST(HammerDesign, RefusesWhatCannotBeMeant) {
  EXPECT_NE(refusal_of([] {
              return hammer_design(bar(), Eigen::MatrixXd(0, 3), plan());
            }).find("no point to hit"),
            std::string::npos);
  auto none = plan();
  none.force_limit_n = kNoLimit;
  EXPECT_NE(refusal_of([&] { return hammer_design(bar(), points(), none); }).find("peak force"),
            std::string::npos);
}

// What the slowest mode asks for has more samples than any integer.
TEST(HammerDesign, ItsRecordHasAnEnd) {
  auto slow = bar();
  slow.model.damping_ratio.setConstant(1e-25);
  auto wanted = plan();
  wanted.low_hz = 39.9;
  wanted.high_hz = 40.1;
  wanted.longest_record_s = 1e30;
  const auto design = hammer_design(slow, points(), wanted);
  EXPECT_EQ(design.samples, 1 << 24);
  EXPECT_NEAR(design.exponential_s, design.record_s / std::log(100.0), 1e-9 * design.record_s);
}

// The mode at 40 Hz is in the band, the lines beside it are at 37.5 and 50 Hz.
TEST(HammerDesign, RefusesABandBetweenTheLinesOfItsRecord) {
  auto wanted = plan();
  wanted.low_hz = 39.5;
  wanted.high_hz = 40.5;
  wanted.longest_record_s = 0.08;
  const auto said = refusal_of([&] { return hammer_design(bar(), points(), wanted); });
  EXPECT_NE(said.find("no line between 39.5 and 40.5 Hz"), std::string::npos) << said;
  EXPECT_NE(said.find("12.4878 Hz apart"), std::string::npos) << said;
}

}  // namespace
}  // namespace chladni::identification
