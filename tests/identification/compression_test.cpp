#include "identification/likelihood/compression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fit_errors.h"
#include "identification/identified.h"
#include "rotation/turn.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;

simulators::FrfCase noisy(Eigen::Index outputs, Eigen::Index inputs, Eigen::Index modes,
                          Eigen::Index lines, unsigned seed) {
  FrfFaults faults;
  faults.relative_noise = 0.0;
  faults.floor_noise = 1.0;
  faults.seed = seed;
  return simulators::big(outputs, inputs, modes, lines, faults);
}

// What the small space leaves of a fit of all responses is a fraction of the bound.
TEST(Compression, LosesAFractionOfTheBound) {
  const auto made = noisy(12, 9, 9, 500, 1);
  const auto data = fit_data(made.measured);
  const auto small = compressed(data);
  ASSERT_TRUE(small.has_value());
  EXPECT_LE(small->data.outputs, 11);
  EXPECT_GE(small->data.inputs, 6);
  const auto direct = modal_fit(data, start_at(made.truth));
  const auto within = modal_fit(small->data, start_at(made.truth));
  const auto fit = expanded(within, *small, data);
  const auto bounds = simulators::cramer_rao(made);
  const auto between = [](const auto& a, const auto& b, const auto& unit) {
    return ((a - b).array() / unit.array()).abs().maxCoeff();
  };
  const auto n = made.truth.mode_count() - 3;
  EXPECT_LT(between(fit.model.frequency_hz.tail(n), direct.model.frequency_hz.tail(n),
                    bounds.frequency_hz.tail(n)),
            0.25);
  EXPECT_LT(between(fit.model.damping_ratio.tail(n), direct.model.damping_ratio.tail(n),
                    bounds.damping.tail(n)),
            0.25);
  EXPECT_LT(between(fit.model.output_shapes.rightCols(n), direct.model.output_shapes.rightCols(n),
                    direct.output_std.rightCols(n)),
            1.0);
  EXPECT_LT(between(fit.output_std.rightCols(n), direct.output_std.rightCols(n),
                    direct.output_std.rightCols(n)),
            0.15);
  EXPECT_LT(between(fit.input_std.rightCols(n), direct.input_std.rightCols(n),
                    direct.input_std.rightCols(n)),
            0.15);
  EXPECT_LT(between(fit.residual_std, direct.residual_std, direct.residual_std), 1e-6);
  EXPECT_EQ(fit.parameter_count, direct.parameter_count);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_LT(fit.cost - direct.cost, 0.02 * static_cast<double>(fit.parameter_count));
}

// Identified takes this way by itself where there are many responses.
TEST(Compression, FindsTheModesOfManyChannels) {
  EVERY_FOURTH_LANDING();
  const auto made = noisy(20, 18, 15, 800, 2);
  IdentificationOptions options;
  options.rigid_count = 3;
  const auto fit = identified(fit_data(made.measured), options).fit;
  ASSERT_EQ(fit.model.mode_count(), 15);
  const auto errors = fit_errors(made.truth, fit);
  ASSERT_EQ(errors.missed, 0);
  EXPECT_LT((errors.frequency_hz.array() / errors.frequency_std_hz.array()).abs().maxCoeff(), 3.5);
  EXPECT_LT((errors.damping.array() / errors.damping_std.array()).abs().maxCoeff(), 3.5);
  EXPECT_GT(errors.mac.minCoeff(), 0.999);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_EQ(fit.model.residual.rows(), 20);
  EXPECT_EQ(fit.residual_std.cols(), 18);
}

TEST(Compression, KeepsTheDelay) {
  FrfFaults faults;
  faults.relative_noise = 0.0;
  faults.floor_noise = 1.0;
  faults.delay_s = 2e-4;
  const auto made = simulators::big(12, 9, 9, 500, faults);
  const auto data = fit_data(made.measured);
  const auto small = compressed(data);
  ASSERT_TRUE(small.has_value());
  FitOptions options;
  options.delay = true;
  const auto fit = expanded(modal_fit(small->data, start_at(made.truth), options), *small, data);
  EXPECT_NEAR(fit.delay_s, faults.delay_s, 4.0 * fit.delay_std_s);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_EQ(fit_errors(made.truth, fit).missed, 0);
}

TEST(Compression, LeavesOutChannelsThatAreNotMeasured) {
  auto made = noisy(12, 9, 9, 500, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(4).setConstant({nan, nan});
  const auto data = fit_data(made.measured);
  const auto small = compressed(data);
  ASSERT_TRUE(small.has_value());
  EXPECT_EQ(small->left.row(4).norm(), 0.0);
  const auto fit = expanded(modal_fit(small->data, start_at(made.truth)), *small, data);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_EQ(fit.output_std(4, 5), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(fit.input_std.allFinite());
}

TEST(Compression, IsRefusedWhereTheNoiseHasNoCommonShape) {
  const auto relative = simulators::beam5x5();
  EXPECT_FALSE(compressed(fit_data(relative.measured)).has_value());
  auto made = noisy(6, 5, 9, 500, 4);
  made.measured.value[7](2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(compressed(fit_data(made.measured)).has_value());
}

}  // namespace
}  // namespace chladni::identification
