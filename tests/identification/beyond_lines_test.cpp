// Modes above the lines: what they add within is measured, and no mode within stands for it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "identification/identified.h"
#include "identification/poles/beyond_lines.h"
#include "identification/poles/residue_problem.h"
#include "identification/trust.h"
#include "rotation/turn.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

constexpr Index kModes = 60;
constexpr Index kWithin = 7;

// 60 modes of random shapes, as dense as those of a beam (n²) or of a plate (n), seven of them
// below the last line.
modal::ReducedModel many_modes(const std::string& body, unsigned seed, Index inputs = 2) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  modal::ReducedModel model;
  model.frequency_hz.resize(kModes);
  for (Index n = 0; n < kModes; ++n) {
    const double order = static_cast<double>(n) + 1.0 + 0.1 * normal(random);
    model.frequency_hz(n) = body == "beam" ? 20.0 * order * order : 120.0 * order;
  }
  model.damping_ratio = Eigen::VectorXd::Constant(kModes, 0.005);
  const auto shapes = [&](Index rows, Index columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  model.output_shapes = shapes(3, kModes);
  model.input_shapes = shapes(kModes, inputs);
  model.input_shapes.col(0) = model.output_shapes.row(0).transpose();  // a collocated pair
  model.residual = Eigen::MatrixXd::Zero(3, inputs);
  return model;
}

modal::FrfSet record(const modal::ReducedModel& truth, double noise, unsigned seed) {
  simulators::FrfGrid grid;
  grid.outputs = Eigen::MatrixX3d::Random(3, 3);
  grid.inputs = Eigen::MatrixX3d::Random(truth.input_shapes.cols(), 3);
  grid.inputs.row(0) = grid.outputs.row(0);
  const double last = 0.5 * (truth.frequency_hz(kWithin - 1) + truth.frequency_hz(kWithin));
  grid.frequency_hz = Eigen::VectorXd::LinSpaced(1200, 0.4 * truth.frequency_hz(0), last);
  simulators::FrfFaults faults;
  faults.relative_noise = noise;
  faults.seed = seed;
  return simulators::frf_case(truth, grid, faults).measured;
}

// The largest error of a frequency within the lines, and how many modes are found there.
struct Within {
  double error = 0.0;
  Index count = 0;
};

Within within(const modal::ReducedModel& truth, const ModalFit& fit, const FitData& data) {
  Within result;
  const auto& found = fit.model.frequency_hz;
  for (Index n = 0; n < kWithin; ++n) {
    const double nearest = (found.array() / truth.frequency_hz(n) - 1.0).abs().minCoeff();
    result.error = std::max(result.error, nearest);
  }
  const double last = data.frequency_hz(data.line_count() - 1);
  result.count = (found.array() < last).count();
  return result;
}

class ModesAbove : public testing::TestWithParam<const char*> {};

// Modes within stood for them: of 160 such records, noise of 0.1 and 1 %, 117 had more than seven,
// and 28 a frequency that was wrong; or the fit ended with residues that were no numbers. Of 240
// others 3 have more than seven now, and one frequency is 1e-4 off.
TEST_P(ModesAbove, AreNoModesWithinTheLines) {
  EVERY_FOURTH_LANDING();
  int wrong = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto truth = many_modes(GetParam(), seed);
    auto set = record(truth, seed % 2 == 0 ? 0.01 : 0.001, seed);
    for (const bool stated : {true, false}) {
      if (!stated) set.variance.clear();
      const auto data = fit_data(set, {.model_error = stated ? 0.0 : 0.01});
      IdentificationOptions options;
      options.fit.delay = true;
      const auto found = identified(data, options);
      const auto seen = within(truth, found.fit, data);
      wrong += seen.count == kWithin ? 0 : 1;
      EXPECT_GE(seen.count, kWithin) << seed << " " << stated;
      EXPECT_LT(seen.error, 1e-4) << seed << " " << stated;
      EXPECT_FALSE(found.drift) << seed << " " << stated;
      EXPECT_LT(noise_level(found.fit, data), 1.2) << seed << " " << stated;
      EXPECT_FALSE(has_mode_without_resonance(data, found.fit)) << seed << " " << stated;
      const auto judgement = judged(found, data, {});
      EXPECT_TRUE(judgement.reasons.empty())
          << seed << " " << stated << ": " << judgement.reasons.front();
    }
  }
  EXPECT_LE(wrong, 1);
}

// A record of which one response was not measured.
modal::FrfSet record_without_one(const modal::ReducedModel& truth, unsigned seed) {
  auto set = record(truth, 0.001, seed);
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k](1, 0) = std::numeric_limits<double>::quiet_NaN();
    set.variance[k](1, 0) = std::numeric_limits<double>::quiet_NaN();
  }
  return set;
}

// A response that was not measured changes nothing of that.
TEST_P(ModesAbove, NeedNotEveryResponse) {
  const auto truth = many_modes(GetParam(), 3);
  const auto data = fit_data(record_without_one(truth, 3));
  const auto found = identified(data, {});
  const auto seen = within(truth, found.fit, data);
  EXPECT_EQ(seen.count, kWithin);
  EXPECT_LT(seen.error, 1e-4);
}

// The same with two modes nearer to each other than half a bandwidth and alike in shape.
modal::ReducedModel with_near_pair(const std::string& body, unsigned seed) {
  constexpr Index kFirst = 4, kSecond = 5;
  constexpr double kAlike = 0.98, kOther = 0.19899749;  // of one shape in the other: 1 in squares
  auto model = many_modes(body, seed, 6);
  model.frequency_hz(kFirst) = 0.996 * model.frequency_hz(kSecond);
  model.output_shapes.col(kFirst) =
      kAlike * model.output_shapes.col(kSecond) + kOther * model.output_shapes.col(kFirst);
  model.input_shapes.row(kFirst) =
      kAlike * model.input_shapes.row(kSecond) + kOther * model.input_shapes.row(kFirst);
  return model;
}

// A model error of 0.3 % that a study states counted as all of what is left, noise of 10 % or not:
// a mode had to take 2 % of it. Of 24 such records 8 had one mode for the pair, and on others a fit
// with a mode above the lines in place of one of the pair counted as good: on the wafer table the
// pair at 1221.7 and 1227.7 Hz was told as 1226.6 and 1227.1 Hz.
TEST_P(ModesAbove, LeaveAPairNearerThanItsBandwidth) {
  for (const unsigned seed : {3U, 6U}) {
    const auto truth = with_near_pair(GetParam(), seed);
    const auto data = fit_data(record(truth, 0.1, seed), {.model_error = 0.003});
    EXPECT_LT(data.error_share, 0.2);
    const auto found = identified(data).fit.model.frequency_hz;
    const double apart = truth.frequency_hz(5) - truth.frequency_hz(4);
    for (const Index n : {4, 5}) {
      const double error = (found.array() - truth.frequency_hz(n)).abs().minCoeff();
      EXPECT_LT(error, 0.2 * apart) << seed << ", mode " << n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, ModesAbove, testing::Values("beam", "plate"),
                         [](const auto& one) { return std::string(one.param); });

TEST(BeyondLines, AModeWithoutAPeakHasNoResonance) {
  const auto data = fit_data(record(many_modes("beam", 1), 0.01, 1));
  const double middle = 2.0 * std::numbers::pi * data.frequency_hz(data.line_count() / 2);
  const auto pole = [&](double frequency, double ratio) {
    return frequency * std::complex<double>(-ratio, std::sqrt(1.0 - ratio * ratio));
  };
  EXPECT_FALSE(has_no_resonance(data, pole(middle, 0.70)));
  EXPECT_TRUE(has_no_resonance(data, pole(middle, 0.71)));
  EXPECT_FALSE(has_no_resonance(data, pole(3.0 * middle, 0.01)));
  EXPECT_TRUE(has_no_resonance(data, pole(1000.0 * middle, 0.01)));
  EXPECT_FALSE(is_beyond_lines(data, data.frequency_hz(0)));
  EXPECT_TRUE(is_beyond_lines(data, 0.4 * data.frequency_hz(0)));
  EXPECT_TRUE(is_beyond_lines(data, 1.2 * data.frequency_hz(data.line_count() - 1)));
}

// Their slope looked like a drift where no variance is stated. The data were corrected for it, and
// had 15 modes within the lines, and a frequency that was 0.3 % off.
TEST(BeyondLines, ModesAboveAreNoDrift) {
  const auto truth = many_modes("beam", 16);
  auto set = record_without_one(truth, 16);
  set.variance.clear();
  const auto data = fit_data(set, {.model_error = 0.01});
  const auto found = identified(data, {});
  EXPECT_FALSE(found.drift);
  EXPECT_LT(within(truth, found.fit, data).error, 1e-4);
}

TEST(BeyondLines, AModeAboveStandsWhereItExplainsMost) {
  const auto truth = many_modes("plate", 1);
  const auto data = fit_data(record(truth, 0.001, 1));
  Start within;
  within.pole.resize(kWithin);
  for (Index n = 0; n < kWithin; ++n) {
    within.pole(n) = 2.0 * std::numbers::pi * truth.frequency_hz(n) *
                     std::complex<double>(-0.005, std::sqrt(1.0 - 0.005 * 0.005));
  }
  const auto more = with_mode_above(data, within, Damping::modal);
  ASSERT_EQ(more.pole.size(), kWithin + 1);
  EXPECT_EQ(more.pole.head(kWithin), within.pole);
  const double last = 2.0 * std::numbers::pi * data.frequency_hz(data.line_count() - 1);
  EXPECT_GT(std::abs(more.pole(kWithin)), last);
  const auto cost = [&](const Eigen::VectorXcd& poles) {
    return ResidueProblem(data, poles, false).residues().cost;
  };
  EXPECT_LT(cost(more.pole), 0.1 * cost(within.pole));
  Eigen::VectorXcd far = more.pole;
  far(kWithin) *= 5.0 * last / std::abs(far(kWithin));
  EXPECT_LT(cost(more.pole), cost(far));
}

}  // namespace
}  // namespace chladni::identification
