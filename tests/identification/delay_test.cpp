#include "identification/delay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/draw.h"
#include "base/error.h"
#include "base/turn.h"
#include "identification/modal_fit.h"
#include "modal/frf.h"
#include "recordings/frf_estimate.h"
#include "tests/recordings/rigs.h"

namespace chladni::identification {
namespace {

// The model's responses, late and with 1 % noise of known variance.
modal::FrfSet noisy(const modal::ReducedModel& model, double delay, double noise, unsigned seed) {
  modal::FrfSet set;
  set.outputs = recordings::channels("y", 2);
  set.inputs = recordings::channels("u", 2);
  set.frequency_hz = Eigen::VectorXd::LinSpaced(300, 5.0, 200.0);
  const auto exact = modal::frf(model, set.frequency_hz);
  Draw draw(seed);
  for (std::size_t k = 0; k < exact.value.size(); ++k) {
    const double omega = kTwoPi * set.frequency_hz(static_cast<Eigen::Index>(k));
    set.value.emplace_back(exact.value[k] * std::polar(1.0, -omega * delay));
    set.variance.emplace_back((noise * exact.value[k].cwiseAbs()).cwiseAbs2());
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double scale = std::sqrt(0.5 * set.variance.back()(i));
      const double real = draw.normal();
      const double imag = draw.normal();
      set.value.back()(i) += scale * std::complex<double>(real, imag);
    }
  }
  return set;
}

TEST(Delay, IsFoundWithinItsDeviationAtKnownPoles) {
  const auto model = recordings::two_modes();
  double squares = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto found =
        delay_at_poles(noisy(model, 3.1e-4, 0.01, seed), start_at(model).pole, false);
    const double error = (found.delay_s - 3.1e-4) / found.std_s;
    EXPECT_LT(std::abs(error), 4.0);
    EXPECT_LT(found.std_s, 1e-6);
    squares += error * error / 40.0;
  }
  EXPECT_NEAR(squares, 1.0, 0.7);  // χ² of 40: ± 0.22
}

TEST(Delay, WithoutVariancesTheResidualTellsTheDeviationOfEqualNoise) {
  const auto model = recordings::two_modes();
  auto set = noisy(model, 3.1e-4, 0.0, 1);
  Draw draw(8);
  for (auto& value : set.value) {
    for (auto& g : value.reshaped()) {
      const double real = draw.normal();
      const double imag = draw.normal();
      g += 1e-6 * std::sqrt(0.5) * std::complex<double>(real, imag);
    }
  }
  for (auto& v : set.variance) v.setConstant(1e-12);
  const auto given = delay_at_poles(set, start_at(model).pole, false);
  set.variance.clear();
  const auto found = delay_at_poles(set, start_at(model).pole, false);
  EXPECT_NEAR(found.delay_s, given.delay_s, 1e-3 * given.std_s);
  EXPECT_NEAR(found.std_s / given.std_s, 1.0, 0.1);  // 2400 real numbers: ± 0.03
  EXPECT_LT(std::abs(found.delay_s - 3.1e-4), 4.0 * found.std_s);
}

TEST(Delay, ThePhaseAloneGivesAFirstValue) {
  const auto model = recordings::two_modes(0.005);
  for (const double delay : {0.0, 2e-4, 2.3e-3}) {
    const auto found = phase_delay(noisy(model, delay, 0.01, 5), 5e-3);
    // Damping: 2 ζ / ω of the lowest mode at the static end.
    EXPECT_NEAR(found.delay_s, delay, 2.0 * 0.005 / (kTwoPi * 20.0)) << delay;
    const auto after =
        delay_at_poles(noisy(model, delay, 0.01, 5), start_at(model).pole, false, found.delay_s);
    EXPECT_LT(std::abs(after.delay_s - delay), 4.0 * after.std_s);
  }
}

// One response differs from no other.
TEST(Delay, ThePhaseOfOneResponseTellsNoDeviation) {
  const auto set = noisy(recordings::two_modes(), 2e-4, 0.01, 5);
  EXPECT_GT(phase_delay(set, 5e-3).std_s, 0.0);
  EXPECT_TRUE(std::isfinite(phase_delay(set, 5e-3).std_s));
  EXPECT_TRUE(std::isinf(phase_delay(modal::part(set, {0}, {1}), 5e-3).std_s));
}

TEST(Delay, VariancesThatAreAllZeroAreNotStated) {
  const auto pole = start_at(recordings::two_modes()).pole;
  auto set = noisy(recordings::two_modes(), 3.1e-4, 0.01, 3);
  auto without = set;
  without.variance.clear();
  for (auto& variance : set.variance) variance.setZero();
  EXPECT_EQ(phase_delay(set, 5e-3).delay_s, phase_delay(without, 5e-3).delay_s);
  const auto found = delay_at_poles(set, pole, false);
  const auto wanted = delay_at_poles(without, pole, false);
  EXPECT_EQ(found.delay_s, wanted.delay_s);
  EXPECT_EQ(found.std_s, wanted.std_s);
}

// A line that is repeated to the last bit is a line.
TEST(Delay, KeepsLinesOfNoVariance) {
  const auto pole = start_at(recordings::two_modes()).pole;
  auto set = noisy(recordings::two_modes(), 3.1e-4, 1e-6, 3);
  const auto all = phase_delay(set, 5e-3);
  for (std::size_t k = 1; k < set.variance.size(); ++k) set.variance[k].setZero();
  EXPECT_EQ(phase_delay(set, 5e-3).delay_s, all.delay_s);
  EXPECT_NEAR(delay_at_poles(set, pole, false).delay_s, 3.1e-4, 1e-8);
}

// The lab's hold and delay, taken away from what it measured, leave the structure's own response.
TEST(Delay, TakenAwayWithTheHoldItLeavesTheContinuousResponse) {
  const auto model = recordings::two_modes();
  auto rig = recordings::rig_of(model, 4096.0);
  rig.delay_s = 2.7 * rig.sample_time_s;
  recordings::VirtualExperimentPlan plan;
  plan.multisine.period = 4096;
  plan.multisine.sample_time_s = rig.sample_time_s;
  plan.multisine.low_hz = 2.0;
  plan.multisine.high_hz = 200.0;
  plan.periods = 1;
  plan.warm_up = 12;
  const auto raw = frf_estimate(virtual_experiment(rig, plan, 1, 1)).set;
  const auto exact = modal::frf(model, raw.frequency_hz);
  const auto error = [&](const modal::FrfSet& set) {
    double largest = 0.0;
    for (std::size_t k = 0; k < set.value.size(); ++k) {
      largest = std::max(largest, (set.value[k] - exact.value[k]).norm() / exact.value[k].norm());
    }
    return largest;
  };
  EXPECT_GT(error(raw), 0.5);
  // What is left folds from beyond half the sampling frequency: (f / fs)² of the response.
  EXPECT_LT(error(without_delay(raw, rig.delay_s, rig.sample_time_s)), 1e-2);
  EXPECT_GT(error(without_delay(raw, rig.delay_s)), 0.1);
  const auto found = delay_at_poles(without_delay(raw, 0.0, rig.sample_time_s),
                                    start_at(model).pole, false, 2.0 * rig.sample_time_s);
  EXPECT_NEAR(found.delay_s, rig.delay_s, 1e-3 * rig.sample_time_s);
}

TEST(Delay, RefusesGrowingPolesAndLinesBeyondHalfTheRate) {
  const auto set = noisy(recordings::two_modes(), 0.0, 0.01, 1);
  Eigen::VectorXcd pole(1);
  pole(0) = {1.0, 100.0};
  EXPECT_THROW((void)delay_at_poles(set, pole, false), InvalidInput);
  EXPECT_THROW((void)without_delay(set, 0.0, 1.0 / 300.0), InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
