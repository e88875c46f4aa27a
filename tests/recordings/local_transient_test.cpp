// The transient of the start, taken off all periods.
#include <gtest/gtest.h>

#include <cmath>

#include "base/turn.h"
#include "identification/delay.h"
#include "modal/frf.h"
#include "recordings/closed_loop.h"
#include "recordings/estimate/local_transient.h"
#include "recordings/frf_estimate.h"
#include "recordings/virtual_experiment.h"
#include "rotation/turn.h"
#include "tests/refusal.h"

namespace chladni::recordings {
namespace {

modal::ReducedModel slow_and_sharp() {
  modal::ReducedModel model;
  model.frequency_hz = Eigen::Vector3d(3.0, 17.0, 41.0);
  model.damping_ratio = Eigen::Vector3d(0.02, 0.01, 0.006);
  model.output_shapes.resize(2, 3);
  model.output_shapes << 1.0, 0.8, -0.7, -0.6, 1.0, 0.9;
  model.input_shapes.resize(3, 1);
  model.input_shapes << 0.9, 1.0, 0.8;
  model.residual.setZero(2, 1);
  return model;
}

VirtualRig rig_of(const modal::ReducedModel& model) {
  VirtualRig rig;
  rig.plant = plant(model);
  rig.outputs.resize(2);
  rig.outputs[0].name = "y1";
  rig.outputs[1].name = "y2";
  rig.inputs.resize(1);
  rig.inputs[0].name = "u1";
  rig.sample_time_s = 1.0 / 256.0;
  return rig;
}

// Starts at rest, no warm-up: the mode at 3 Hz leaves 22 % from period to period.
TimeData started(const VirtualRig& rig, Eigen::Index periods, int realisations) {
  VirtualExperimentPlan plan;
  plan.multisine.period = 1024;
  plan.multisine.sample_time_s = rig.sample_time_s;
  plan.multisine.low_hz = 1.0;
  plan.multisine.high_hz = 60.0;
  plan.periods = periods;
  return virtual_experiment(rig, plan, realisations, 7);
}

// Largest error within two bandwidths of the modes, relative.
double error_at_modes(const modal::FrfSet& estimate, const modal::ReducedModel& model,
                      double sample_time_s) {
  const auto set = identification::without_delay(estimate, 0.0, sample_time_s);
  const auto exact = modal::frf(model, set.frequency_hz);
  double worst = 0.0;
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const double hz = set.frequency_hz(static_cast<Eigen::Index>(k));
    for (Eigen::Index m = 0; m < 3; ++m) {
      const double half = model.damping_ratio(m) * model.frequency_hz(m);
      if (std::abs(hz - model.frequency_hz(m)) > 4.0 * half) continue;
      worst = std::max(worst, (set.value[k] - exact.value[k]).cwiseAbs().maxCoeff() /
                                  exact.value[k].cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

FrfEstimateOptions removing() {
  FrfEstimateOptions options;
  options.remove_transient = true;
  return options;
}

FrfEstimateOptions dropping(Eigen::Index periods) {
  FrfEstimateOptions options;
  options.drop = periods;
  return options;
}

// Without noise: dropping periods needs several to do what the lines between give at once.
TEST(LocalTransient, IsTakenOffWithoutDroppingAPeriod) {
  const auto model = slow_and_sharp();
  const auto rig = rig_of(model);
  const auto data = started(rig, 6, 1);
  const auto error = [&](const FrfEstimateOptions& options) {
    return error_at_modes(frf_estimate(data, options).set, model, rig.sample_time_s);
  };
  const double removed = error(removing());
  EXPECT_LT(removed, 2e-3);
  EXPECT_LT(removed, 0.05 * error(dropping(1)));
  EXPECT_LT(removed, error(dropping(3)));
  EXPECT_EQ(frf_estimate(data, removing()).periods, 6);
  EXPECT_EQ(frf_estimate(data, removing()).dropped, 0);
}

TEST(LocalTransient, TwoPeriodsAreEnough) {
  const auto model = slow_and_sharp();
  const auto rig = rig_of(model);
  const auto data = started(rig, 2, 1);
  EXPECT_LT(error_at_modes(frf_estimate(data, removing()).set, model, rig.sample_time_s),
            0.1 * error_at_modes(frf_estimate(data, dropping(1)).set, model, rig.sample_time_s));
}

// The stated variances are those of the errors: Σ |error|² / variance over lines is their number.
TEST(LocalTransient, StatesTheVarianceOfWhatItLeaves) {
  const auto model = slow_and_sharp();
  auto rig = rig_of(model);
  rig.sensor_noise = Eigen::Vector2d(2e-5, 3e-5);
  for (const int realisations : {1, 6}) {
    const auto data = started(rig, 8, realisations);
    const auto set =
        identification::without_delay(frf_estimate(data, removing()).set, 0.0, rig.sample_time_s);
    const auto exact = modal::frf(model, set.frequency_hz);
    for (Eigen::Index i = 0; i < 2; ++i) {
      double chi = 0.0;
      double noise = 0.0;
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        const double squared = std::norm(set.value[k](i, 0) - exact.value[k](i, 0));
        chi += squared / set.variance[k](i, 0);
        noise += squared / set.noise_variance[k](i, 0);
      }
      const auto count = static_cast<double>(set.value.size());
      // 13 degrees of freedom per realisation: ν/(ν − 1) = 1.08.
      EXPECT_NEAR(chi / count, 1.08, 0.25);
      EXPECT_NEAR(noise / count, 1.05, 0.25);
    }
  }
}

// The scatter of a variance over the noise is that of its degrees of freedom, 1/ν of its square. Of
// two periods a variance and its neighbours have nearly the same lines between.
TEST(LocalTransient, StatesHowWellItsVarianceIsKnown) {
  EVERY_FOURTH_LANDING();
  const auto rig = rig_of(slow_and_sharp());
  auto options = removing();
  options.low_hz = 19.0;
  options.high_hz = 38.0;
  Draw draw(5);
  for (const Eigen::Index periods : {2, 5, 18}) {
    const auto quiet = started(rig, periods, 1);
    Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(4);
    Eigen::ArrayXd square = Eigen::ArrayXd::Zero(4);
    double stated = 0.0;
    constexpr int kTimes = 60;
    for (int time = 0; time < kTimes; ++time) {
      auto data = quiet;
      for (double& value : data.records[0].outputs.reshaped()) value = draw.normal();
      const auto set = frf_estimate(data, options).set;
      stated = set.averages;
      for (Eigen::Index i = 0; i < 4; ++i) {  // lines with nothing in common
        const double one = set.variance[static_cast<std::size_t>(6 + 20 * i)](0, 0);
        sum(i) += one / kTimes;
        square(i) += one * one / kTimes;
      }
    }
    const double relative = ((square - sum.square()) / sum.square()).mean() * kTimes / (kTimes - 1);
    EXPECT_NEAR(relative * stated, 1.0, 0.35) << periods << " " << stated;
  }
}

// Without a transient nothing is lost beside the plain mean of all periods.
TEST(LocalTransient, CostsLittleWhereThereIsNone) {
  const auto model = slow_and_sharp();
  auto rig = rig_of(model);
  rig.sensor_noise = Eigen::Vector2d(2e-5, 3e-5);
  VirtualExperimentPlan plan;
  plan.multisine.period = 1024;
  plan.multisine.sample_time_s = rig.sample_time_s;
  plan.multisine.low_hz = 1.0;
  plan.multisine.high_hz = 60.0;
  plan.periods = 4;
  plan.warm_up = 20;
  const auto data = virtual_experiment(rig, plan, 4, 3);
  const auto sum = [&](const FrfEstimateOptions& options) {
    const auto set =
        identification::without_delay(frf_estimate(data, options).set, 0.0, rig.sample_time_s);
    const auto exact = modal::frf(model, set.frequency_hz);
    double squares = 0.0;
    for (std::size_t k = 0; k < set.value.size(); ++k) {
      squares += (set.value[k] - exact.value[k]).squaredNorm();
    }
    return squares;
  };
  EXPECT_LT(sum(removing()), 1.35 * sum(dropping(0)));
  EXPECT_LT(sum(removing()), sum(dropping(1)) * 1.1);
}

TEST(LocalTransient, RefusesOnePeriodAndTooShortOnes) {
  const auto rig = rig_of(slow_and_sharp());
  EXPECT_NE(refusal_of([&] {
              return frf_estimate(started(rig, 1, 1), removing());
            }).find("a record of one period"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::recordings
