// Delays of each channel, of 0 to 5 samples of 2 ms: up to two periods of the highest line.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "fit_errors.h"
#include "identification/delay_scan.h"
#include "identification/identified.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;

const Eigen::VectorXd kDelay = 2e-3 * Eigen::VectorXd{{0.0, 5.0, 1.3, 2.0, 3.7}};  // [s]

simulators::FrfCase delayed(unsigned seed) {
  FrfFaults faults;
  faults.output_delay_s = kDelay;
  faults.seed = seed;
  return simulators::beam5x3(faults);
}

IdentificationOptions each_output() {
  IdentificationOptions options;
  options.fit.delay = true;
  options.fit.delay_of = DelayOf::outputs;
  return options;
}

Eigen::VectorXd all_delays(const ModalFit& fit) {
  return fit.channel_delay_s.array() + fit.delay_s;
}

// Input for output: G transposed.
FitData turned(const FitData& data) {
  FitData result = data;
  std::swap(result.outputs, result.inputs);
  for (Eigen::Index i = 0; i < data.outputs; ++i) {
    for (Eigen::Index j = 0; j < data.inputs; ++j) {
      result.value.col(j + data.inputs * i) = data.value.col(i + data.outputs * j);
      result.weight.col(j + data.inputs * i) = data.weight.col(i + data.outputs * j);
    }
  }
  return result;
}

constexpr int kSeeds = 20;

TEST(ChannelDelays, AreFoundAtTheBoundAndLeaveTheModesUnbiased) {
  const auto bounds = simulators::cramer_rao(delayed(1), {.output_delays = true});
  double delays = 0.0;
  double stated = 0.0;
  double damping = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto made = delayed(seed);
    const auto fit = identified(fit_data(made.measured), each_output()).fit;
    ASSERT_EQ(fit.channel_delay_s.size(), 5) << seed;
    ASSERT_EQ(fit.model.mode_count(), 5) << seed;
    const Eigen::ArrayXd error = all_delays(fit) - kDelay;
    EXPECT_LT((error.abs() / bounds.output_delay_s.array()).maxCoeff(), 4.0) << seed;
    delays += (error / bounds.output_delay_s.array()).square().mean() / kSeeds;
    stated += (fit.channel_delay_std_s.array() / bounds.output_delay_s.array()).mean() / kSeeds;
    const auto errors = fit_errors(made.truth, fit);
    ASSERT_EQ(errors.missed, 0) << seed;
    damping += (errors.damping.array() / bounds.damping.array()).square().mean() / kSeeds;
    EXPECT_LT(std::abs(excess(fit)), 4.0) << seed;
  }
  // 100 numbers each: the roots are 1 ± 0.07.
  EXPECT_NEAR(std::sqrt(delays), 1.0, 0.25);
  EXPECT_NEAR(std::sqrt(damping), 1.0, 0.25);
  EXPECT_NEAR(stated, 1.0, 0.1);
}

TEST(ChannelDelays, AreNotThoseOfOneForAll) {
  const auto made = delayed(1);
  const auto data = fit_data(made.measured);
  FitOptions options;
  options.delay = true;
  EXPECT_GT(excess(modal_fit(data, start_at(made.truth), options)), 100.0);
}

// With the delays of the first three outputs: they are the inputs of the beam turned around.
TEST(ChannelDelays, OfInputsAreThoseOfOutputsTurnedAround) {
  const auto data = fit_data(delayed(2).measured);
  const auto outputs = identified(data, each_output()).fit;
  auto options = each_output();
  options.fit.delay_of = DelayOf::inputs;
  const auto inputs = identified(turned(data), options).fit;
  ASSERT_EQ(inputs.channel_delay_s.size(), 5);
  EXPECT_EQ(inputs.delay_of, DelayOf::inputs);
  const Eigen::ArrayXd off = all_delays(inputs) - all_delays(outputs);
  EXPECT_LT((off.abs() / outputs.channel_delay_std_s.array()).maxCoeff(), 0.05);
  EXPECT_NEAR(inputs.delay_std_s / outputs.delay_std_s, 1.0, 0.01);
  EXPECT_NEAR(inputs.cost / outputs.cost, 1.0, 1e-5);
  const Eigen::MatrixXcd response = responses(inputs, data.frequency_hz);
  const double weighted =
      (response - turned(data).value).cwiseProduct(turned(data).weight).squaredNorm();
  EXPECT_NEAR(weighted / inputs.cost, 1.0, 1e-6);
}

TEST(ChannelDelays, OfAChannelThatIsNotMeasuredAreNotKnown) {
  auto made = delayed(3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(2).setConstant({nan, nan});
  const auto fit = identified(fit_data(made.measured), each_output()).fit;
  EXPECT_EQ(fit.channel_delay_std_s(2), std::numeric_limits<double>::infinity());
  for (const Eigen::Index i : {0, 1, 3, 4}) {
    EXPECT_NEAR(all_delays(fit)(i), kDelay(i), 4.0 * fit.channel_delay_std_s(i)) << i;
  }
  EXPECT_NEAR(fit.delay_s, (kDelay.sum() - kDelay(2)) / 4.0, 4.0 * fit.delay_std_s);
}

// A long delay bends the phases so much that a vector fit finds other poles. Lines 0.25 Hz apart
// tell delays up to two seconds, 400 periods of the highest line.
TEST(ChannelDelays, AreFoundOfManyPeriods) {
  const double period = 1.0 / 200.0;
  for (const double noise : {0.01, 0.1}) {
    for (const double periods : {2.0, 2.8, 3.0, 12.0, 150.0}) {
      FrfFaults faults;
      faults.relative_noise = noise;
      faults.delay_s = periods * period;
      const auto made = simulators::beam5x3(faults);
      auto options = each_output();
      options.fit.delay_of = DelayOf::all;
      const auto fit = identified(fit_data(made.measured), options).fit;
      EXPECT_NEAR(fit.delay_s, faults.delay_s, 4.0 * fit.delay_std_s) << noise << " " << periods;
      EXPECT_EQ(fit.model.mode_count(), 5) << noise << " " << periods;
      EXPECT_LT(std::abs(excess(fit)), 4.0) << noise << " " << periods;
    }
  }
}

TEST(ChannelDelays, OfManyPeriodsAreEachTheirOwn) {
  FrfFaults faults;
  faults.output_delay_s = 10.0 * kDelay;
  const auto made = simulators::beam5x3(faults);
  const auto fit = identified(fit_data(made.measured), each_output()).fit;
  ASSERT_EQ(fit.channel_delay_s.size(), 5);
  EXPECT_LT(((all_delays(fit) - 10.0 * kDelay).array() / fit.channel_delay_std_s.array())
                .abs()
                .maxCoeff(),
            4.0);
  EXPECT_EQ(fit.model.mode_count(), 5);
}

// The phases alone tell a delay to a part of a period; where nothing was measured it is 0.
TEST(ChannelDelays, AreSeenInThePhasesAlone) {
  auto made = delayed(4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(2).setConstant({nan, nan});
  const auto data = fit_data(made.measured);
  const auto found = phase_delays(data, DelayOf::outputs);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const auto i = e % data.outputs;
    EXPECT_NEAR(found(e), i == 2 ? 0.0 : kDelay(i), 0.1 / 200.0) << e;
  }
}

// Many sensors of many lines take minutes: each is told, and Ctrl-C ends the search within one.
TEST(ChannelDelays, AreToldAndEndAtCtrlC) {
  const auto data = fit_data(delayed(4).measured);
  double last = -1.0;
  int told = 0;
  (void)phase_delays(data, DelayOf::outputs, [&](std::string_view, double fraction) {
    EXPECT_GT(fraction, last);
    EXPECT_LT(fraction, 1.0);
    last = fraction;
    ++told;
  });
  EXPECT_EQ(told, 5);
  const NotedInterrupts noted;
  told = 0;
  const auto stop = [&](std::string_view, double) {
    ++told;
    if (told == 2) std::raise(SIGINT);
  };
  EXPECT_THROW((void)phase_delays(data, DelayOf::outputs, stop), Interrupted);
  EXPECT_EQ(told, 2);
  forget_interrupt();
}

}  // namespace
}  // namespace chladni::identification
