#include "recordings/frf_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "modal/state_space.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

// What a noiseless experiment in the steady state must give: the discrete model's response.
std::vector<Eigen::MatrixXcd> true_response(const modal::ReducedModel& model,
                                            const modal::FrfSet& set, double sample_time) {
  const auto space = modal::discretised(modal::state_space(model), sample_time);
  std::vector<Eigen::MatrixXcd> result;
  for (const double f : set.frequency_hz) result.push_back(modal::response(space, f));
  return result;
}

double largest_error(const modal::FrfSet& set, const std::vector<Eigen::MatrixXcd>& want) {
  double largest = 0.0;
  for (std::size_t k = 0; k < want.size(); ++k) {
    largest = std::max(largest, (set.value[k] - want[k]).norm() / want[k].norm());
  }
  return largest;
}

TEST(FrfEstimate, IsTheDiscreteResponseWithoutNoise) {
  const auto model = two_modes();
  const auto rig = rig_of(model, 512.0);
  for (const auto scheme : {InputScheme::one_at_a_time, InputScheme::orthogonal}) {
    auto plan = plan_of_seconds(2);
    plan.scheme = scheme;
    plan.warm_up = 12;
    const auto found = frf_estimate(virtual_experiment(rig, plan, 2, 1));
    ASSERT_EQ(found.set.frequency_hz.size(), 76);
    EXPECT_EQ(found.set.frequency_hz(0), 5.0);
    EXPECT_LT(largest_error(found.set, true_response(model, found.set, rig.sample_time_s)), 1e-9);
  }
}

struct Scatter {
  double bias = 0.0, variance_ratio = 0.0, stated = 0.0;
  long count = 0;
};

// Mean of (G − G₀)/s, of |G − G₀|²/s² over lines, channels and seeds, s² the stated variance's
// mean.
Scatter scatter(InputScheme scheme, bool total, int realisations) {
  const auto model = two_modes(0.05);
  auto rig = rig_of(model, 512.0);
  rig.sensor_noise = Eigen::Vector2d(1e-4, 3e-5);
  auto plan = plan_of_seconds(5);
  plan.scheme = scheme;
  plan.warm_up = 4;
  FrfEstimateOptions options;
  options.drop = 0;
  options.smooth_lines = 0;
  Scatter result;
  std::complex<double> bias = 0.0;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto found = frf_estimate(virtual_experiment(rig, plan, realisations, seed), options);
    const auto want = true_response(model, found.set, rig.sample_time_s);
    for (std::size_t k = 0; k < want.size(); ++k) {
      for (Eigen::Index i = 0; i < 2; ++i) {
        for (Eigen::Index j = 0; j < 2; ++j) {
          const auto error = found.set.value[k](i, j) - want[k](i, j);
          const double scale = i == 0 ? 1e-4 : 3e-5;
          bias += error / scale;
          squares += std::norm(error / scale);
          const auto& stated = total ? found.set.variance[k] : found.set.noise_variance[k];
          result.stated += stated(i, j) / (scale * scale);
          ++result.count;
        }
      }
    }
  }
  const auto n = static_cast<double>(result.count);
  result.bias = std::abs(bias) / std::sqrt(n * squares);
  result.variance_ratio = squares / result.stated;
  result.stated /= n;
  return result;
}

// 12 seeds · 76 lines · 4 responses: the ratio of two χ² means is 1 ± 0.03; the bias, over the
// deviation of a mean, has the length of a complex normal: beyond 3 in 1e-4 of cases.
TEST(FrfEstimate, IsUnbiasedAndItsVarianceIsTrue) {
  for (const auto scheme : {InputScheme::one_at_a_time, InputScheme::orthogonal}) {
    for (const bool total : {true, false}) {
      const auto found = scatter(scheme, total, 4);
      EXPECT_LT(found.bias, 3.0);
      EXPECT_NEAR(found.variance_ratio, 1.0, 0.1);
    }
  }
}

TEST(FrfEstimate, OrthogonalInputsHaveQTimesLessNoise) {
  const auto one = scatter(InputScheme::one_at_a_time, false, 2);
  const auto both = scatter(InputScheme::orthogonal, false, 2);
  EXPECT_NEAR(one.stated / both.stated, 2.0, 0.1);
}

TEST(FrfEstimate, TellsNoiseFromNonlinearity) {
  const auto model = two_modes(0.05);
  auto rig = rig_of(model, 512.0);
  auto plan = plan_of_seconds(4);
  plan.warm_up = 5;
  plan.scheme = InputScheme::one_at_a_time;
  FrfEstimateOptions options;
  options.drop = 0;
  options.smooth_lines = 5;
  const auto share = [&](double stiffness, double noise) {
    rig.spring = CubicSpring{.stiffness = stiffness, .output = 0, .input = 0};
    rig.substeps = 2;
    rig.sensor_noise = Eigen::Vector2d::Constant(noise);
    const auto set = frf_estimate(virtual_experiment(rig, plan, 6, 2), options).set;
    Eigen::Vector2d sum(0.0, 0.0);
    for (std::size_t k = 0; k < set.variance.size(); ++k) {
      sum += Eigen::Vector2d(set.variance[k].sum(), set.noise_variance[k].sum());
    }
    return sum;
  };
  const auto linear = share(0.0, 1e-6);
  const auto cubic = share(1e10, 1e-6);
  EXPECT_NEAR(linear(0) / linear(1), 1.0, 0.15);
  EXPECT_GT(cubic(0) / cubic(1), 20.0);          // most is nonlinear now
  EXPECT_NEAR(cubic(1) / linear(1), 1.0, 0.15);  // and the noise is what it was
}

TEST(FrfEstimate, SaysWhatOnePeriodOrOneRealisationCannotTell) {
  const auto rig = rig_of(two_modes(), 512.0);
  const auto single = frf_estimate(virtual_experiment(rig, plan_of_seconds(1), 1, 1));
  EXPECT_TRUE(single.set.variance.empty());
  EXPECT_EQ(single.set.averages, 0.0);
  EXPECT_GE(single.notes.size(), 2U);
  const auto two = frf_estimate(virtual_experiment(rig, plan_of_seconds(1), 2, 1));
  EXPECT_FALSE(two.set.variance.empty());
  EXPECT_TRUE(two.set.noise_variance.empty());
}

TEST(FrfEstimate, NamesLinesOntoWhichMotionFolds) {
  const auto rig = rig_of(two_modes(), 512.0);
  auto plan = plan_of_seconds(3);
  plan.multisine.high_hz = 250.0;
  bool named = false;
  for (const auto& note : frf_estimate(virtual_experiment(rig, plan, 2, 1)).notes) {
    named = named || note.find("folds") != std::string::npos;
  }
  EXPECT_TRUE(named);
}

TEST(FrfEstimate, RefusesPeriodsThatAreNotWholeOrDoNotRepeat) {
  const auto rig = rig_of(two_modes(), 512.0);
  const auto good = virtual_experiment(rig, plan_of_seconds(4), 1, 1);
  auto data = good;
  data.period = 500;
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  data.period = 0;
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  data.period = 256;  // whole, but the signal repeats after 512
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  data = good;
  data.records.pop_back();  // one experiment for two inputs
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  data = good;
  data.records[1].inputs = data.records[0].inputs;  // the same experiment twice
  data.records[1].outputs = data.records[0].outputs;
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  data = good;
  data.records[0].outputs(3, 1) = std::nan("");
  EXPECT_THROW((void)frf_estimate(data), InvalidInput);
  FrfEstimateOptions options;
  options.drop = 4;
  EXPECT_THROW((void)frf_estimate(good, options), InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
