#include "recordings/hammer.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"
#include "modal/state_space.h"
#include "tests/recordings/rigs.h"
#include "tests/refusal.h"

namespace chladni::recordings {
namespace {

using Complex = std::complex<double>;

// A gain of 2 between white signals, with noise of given power on force and response.
TimeData gain_of_two(double on_force, double on_response, int hits) {
  TimeData data;
  data.outputs = channels("y", 1);
  data.inputs = channels("f", 1);
  data.sample_time_s = 1e-3;
  Draw draw(9);
  for (int i = 0; i < hits; ++i) {
    Record record;
    record.inputs.resize(256, 1);
    record.outputs.resize(256, 1);
    record.references.resize(256, 0);
    for (Eigen::Index n = 0; n < 256; ++n) {
      const double f = draw.normal();
      record.inputs(n, 0) = f + std::sqrt(on_force) * draw.normal();
      record.outputs(n, 0) = 2.0 * f + std::sqrt(on_response) * draw.normal();
    }
    data.records.push_back(record);
  }
  return data;
}

double mean_gain(const modal::FrfSet& set) {
  double sum = 0.0;
  for (const auto& value : set.value) sum += value(0, 0).real();
  return sum / static_cast<double>(set.value.size());
}

// 200 hits, 129 lines: a mean is known to 0.3 %.
TEST(Hammer, H1AndH2HaveTheBiasesOfTheTextbook) {
  const auto noisy_force = hammer_estimate(gain_of_two(0.25, 0.0, 200));
  EXPECT_NEAR(mean_gain(noisy_force.h1), 2.0 / 1.25, 0.02);
  EXPECT_NEAR(mean_gain(noisy_force.h2), 2.0, 0.02);
  const auto noisy_response = hammer_estimate(gain_of_two(0.0, 1.0, 200));
  EXPECT_NEAR(mean_gain(noisy_response.h1), 2.0, 0.02);
  EXPECT_NEAR(mean_gain(noisy_response.h2), 2.0 * 1.25, 0.03);
  double coherence = 0.0;
  for (const auto& value : noisy_response.h1.coherence) coherence += value(0, 0);
  EXPECT_NEAR(coherence / 129.0, 0.8, 0.01);
}

TEST(Hammer, ItsVarianceIsWhatH1ScattersBy) {
  const auto found = hammer_estimate(gain_of_two(0.0, 1.0, 40)).h1;
  double squares = 0.0;
  double stated = 0.0;
  for (std::size_t k = 1; k + 1 < found.value.size(); ++k) {
    squares += std::norm(found.value[k](0, 0) - 2.0);
    stated += found.variance[k](0, 0);
  }
  EXPECT_NEAR(squares / stated, 1.0, 0.3);  // 127 complex numbers: ± 0.09
  EXPECT_EQ(found.averages, 39.0);
}

// Blows on the disk give the bits of those in memory, one record at a time.
TEST(Hammer, BlowsThatAreReadOneByOneGiveTheSameBits) {
  const auto data = gain_of_two(0.1, 0.2, 12);
  const auto whole = recordings_of(data);
  std::vector<std::size_t> asked;
  auto pieces = whole;
  pieces.samples = [&](std::size_t record, Side side, Eigen::Index channel, Eigen::Index first,
                       Eigen::Index count) {
    if (asked.empty() || asked.back() != record) asked.push_back(record);
    return whole.samples(record, side, channel, first, count);
  };
  for (const HammerOptions& options :
       {HammerOptions{}, HammerOptions{.force_window_s = 0.02, .exponential_s = 0.1}}) {
    asked.clear();
    const auto found = hammer_estimate(pieces, options);
    const auto expected = hammer_estimate(data, options);
    EXPECT_EQ(found.notes, expected.notes);
    EXPECT_EQ(found.h1.averages, expected.h1.averages);
    ASSERT_EQ(found.h1.value.size(), expected.h1.value.size());
    for (std::size_t k = 0; k < found.h1.value.size(); ++k) {
      EXPECT_EQ(found.h1.value[k], expected.h1.value[k]);
      EXPECT_EQ(found.h2.value[k], expected.h2.value[k]);
      EXPECT_EQ(found.h1.variance[k], expected.h1.variance[k]);
    }
    EXPECT_EQ(asked.size(), data.records.size());
  }
}

// One mode, struck once, measured for less time than it takes to die away.
TimeData struck(double seconds) {
  const auto model = model_of(Eigen::VectorXd::Constant(1, 20.0), 0.01, Eigen::MatrixXd::Ones(1, 1),
                              Eigen::MatrixXd::Ones(1, 1));
  const auto rig = rig_of(model, 512.0);
  const auto samples = static_cast<Eigen::Index>(std::lround(512.0 * seconds));
  Eigen::MatrixXd blow = Eigen::MatrixXd::Zero(samples, 1);
  blow(3, 0) = 100.0;
  Draw draw(1);
  TimeData data;
  data.outputs = rig.outputs;
  data.inputs = rig.inputs;
  data.sample_time_s = rig.sample_time_s;
  data.records.push_back(recorded(rig, blow, draw));
  return data;
}

TEST(Hammer, AnExponentialWindowOnlyShiftsTheDecay) {
  HammerOptions options;
  options.exponential_s = 0.25;
  options.low_hz = 5.0;
  options.high_hz = 60.0;
  const auto found = hammer_estimate(struck(4.0), options);
  EXPECT_EQ(found.added_decay, 4.0);
  const auto model = model_of(Eigen::VectorXd::Constant(1, 20.0), 0.01, Eigen::MatrixXd::Ones(1, 1),
                              Eigen::MatrixXd::Ones(1, 1));
  const auto space = modal::discretised(modal::state_space(model), 1.0 / 512.0);
  for (std::size_t k = 0; k < found.h1.value.size(); ++k) {
    const double omega =
        2.0 * std::numbers::pi * found.h1.frequency_hz(static_cast<Eigen::Index>(k));
    const Complex z = std::exp(Complex(4.0, omega) / 512.0);
    const Eigen::MatrixXcd pencil = z * Eigen::MatrixXcd::Identity(2, 2) - space.a;
    const Complex want = (space.c * pencil.partialPivLu().solve(space.b.cast<Complex>()))(0, 0);
    // What the window leaves at the end: e^{-16} e^{-5}.
    EXPECT_LT(std::abs(found.h1.value[k](0, 0) - want), 1e-6 * std::abs(want));
  }
  Eigen::VectorXcd pole(1);
  pole(0) = {-5.0, 100.0};
  EXPECT_NEAR(true_poles(pole, 4.0)(0).real(), -1.0, 1e-15);
  EXPECT_THROW((void)true_poles(pole, 6.0), InvalidInput);
}

TEST(Hammer, ForceWindowsKeepNoiseOut) {
  auto data = struck(16.0);
  Draw draw(2);
  for (double& f : data.records[0].inputs.reshaped()) f += 0.2 * draw.normal();
  const auto truth = hammer_estimate(struck(16.0)).h1;
  const auto error = [&](double window) {
    HammerOptions options;
    options.force_window_s = window;
    const auto found = hammer_estimate(data, options).h1;
    double sum = 0.0;
    for (std::size_t k = 100; k < 1000; ++k) {
      sum += std::norm(found.value[k](0, 0) / truth.value[k](0, 0) - 1.0);
    }
    return std::sqrt(sum / 900.0);
  };
  EXPECT_GT(error(0.0), 0.1);
  EXPECT_LT(error(0.02), 0.02);
}

TEST(Hammer, NamesDoubleHitsAndRecordsThatAreTooShort) {
  auto data = struck(8.0);
  data.records[0].inputs(800, 0) = 30.0;
  HammerOptions options;
  options.force_window_s = 0.05;
  const auto has = [](const HammerEstimate& estimate, const std::string& word) {
    for (const auto& note : estimate.notes) {
      if (note.find(word) != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(has(hammer_estimate(data, options), "second hit"));
  EXPECT_TRUE(has(hammer_estimate(struck(1.0)), "rest"));
  EXPECT_FALSE(has(hammer_estimate(struck(8.0)), "rest"));
  EXPECT_TRUE(has(hammer_estimate(struck(8.0)), "one hit"));
}

TEST(Hammer, RefusesRecordsThatDoNotFit) {
  auto data = struck(2.0);
  data.records.push_back(struck(1.0).records[0]);
  EXPECT_THROW((void)hammer_estimate(data), InvalidInput);
  data = struck(2.0);
  data.records[0].experiment = 1;
  EXPECT_THROW((void)hammer_estimate(data), InvalidInput);
  data = struck(2.0);
  data.records[0].inputs.setZero();
  EXPECT_THROW((void)hammer_estimate(data), InvalidInput);
}

TEST(Hammer, RefusesRecordsOfOneSideByItsName) {
  auto data = struck(2.0);
  data.outputs.clear();
  data.records[0].outputs.resize(data.records[0].outputs.rows(), 0);
  EXPECT_EQ(refusal_of([&] { return hammer_estimate(data); }),
            "hammer: no output (sensor) among the channels, 1 input; expected one or more of both");
  data = struck(2.0);
  data.inputs.clear();
  data.records[0].inputs.resize(data.records[0].inputs.rows(), 0);
  EXPECT_NE(refusal_of([&] { return hammer_estimate(data); }).find("hammer: no input (force"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::recordings
