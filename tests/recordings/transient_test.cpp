#include "recordings/estimate/transient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.h"
#include "base/turn.h"
#include "identification/modal_fit.h"
#include "modal/state_space.h"
#include "recordings/frf_estimate.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

// The thesis' grid (4.1.1) on its simulated beam: 4096 Hz, 16384 samples, 10 periods.
constexpr double kSampling = 4096.0;
constexpr Eigen::Index kTransientPeriod = 16384;

modal::ReducedModel beam() {
  const Eigen::VectorXd at = Eigen::Vector3d(0.05, 0.15, 0.35);
  auto model = reduced_model(matrices(beam_with_carried_body()), at, at.head(1), 6);
  model.residual.setZero();
  return model;
}

VirtualExperimentPlan thesis_plan() {
  VirtualExperimentPlan plan;
  plan.multisine.period = kTransientPeriod;
  plan.multisine.sample_time_s = 1.0 / kSampling;
  plan.multisine.low_hz = 0.25;
  plan.multisine.high_hz = 200.0;
  return plan;
}

struct Truth {
  modal::ReducedModel model;
  std::vector<Eigen::MatrixXcd> response;
};

Truth truth_of(const modal::FrfSet& set) {
  Truth truth{beam(), {}};
  const auto space = modal::discretised(modal::state_space(truth.model), 1.0 / kSampling);
  for (const double f : set.frequency_hz) truth.response.push_back(modal::response(space, f));
  return truth;
}

// Largest relative error within three half-power bandwidths of each mode, any channel.
Eigen::VectorXd error_at_modes(const modal::FrfSet& set) {
  const auto truth = truth_of(set);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(truth.model.mode_count());
  for (Eigen::Index k = 0; k < set.frequency_hz.size(); ++k) {
    const auto& want = truth.response[static_cast<std::size_t>(k)];
    const double error = (set.value[static_cast<std::size_t>(k)] - want).norm() / want.norm();
    for (Eigen::Index m = 0; m < result.size(); ++m) {
      const double f = truth.model.frequency_hz(m);
      const double near = std::max(3.0 * truth.model.damping_ratio(m) * f, 0.26);
      if (std::abs(set.frequency_hz(k) - f) < near) result(m) = std::max(result(m), error);
    }
  }
  return result;
}

VirtualRig transient_rig() { return rig_of(beam(), kSampling); }

FrfEstimateOptions dropping(Eigen::Index periods) {
  FrfEstimateOptions options;
  options.drop = periods;
  return options;
}

TEST(Transient, DroppingOnePeriodLeavesPercentsAtTheModes) {
  const auto data = virtual_experiment(transient_rig(), thesis_plan(), 1, 1);
  const auto once = error_at_modes(frf_estimate(data, dropping(1)).set);
  EXPECT_GT(once.maxCoeff(), 0.02);
  // The poles of the first fit take it away altogether.
  const auto clean = without_transient(data, identification::start_at(beam()).pole).data;
  const auto after = error_at_modes(frf_estimate(clean, dropping(0)).set);
  EXPECT_LT(after.maxCoeff(), 1e-7) << after.transpose();
}

TEST(Transient, IsAlwaysSeenOnTheThesisGrid) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    auto noisy = transient_rig();
    const auto size = virtual_experiment(noisy, thesis_plan(), 1, seed).records[0].outputs;
    const double rms = size.norm() / std::sqrt(static_cast<double>(size.size()));
    noisy.sensor_noise = Eigen::Vector3d::Constant(0.01 * rms);
    const auto report =
        transient(spectra(virtual_experiment(noisy, thesis_plan(), 1, seed), 0.25, 200.0));
    EXPECT_TRUE(report.seen);
    EXPECT_GT(report.drop, 1);
    EXPECT_GT(report.first, 1.0);
    EXPECT_NEAR(report.decay, 0.285, 0.06);  // exp(−ζωT) of the mode at 2.5 Hz
  }
}

// Bias of the mean FRF, over its deviation: below 0.1 after the removal, and far above before.
TEST(Transient, ItsRemovalLeavesLessThanATenthOfTheDeviation) {
  auto noisy = transient_rig();
  const auto exact = virtual_experiment(noisy, thesis_plan(), 1, 3).records[0].outputs;
  const double rms = exact.norm() / std::sqrt(static_cast<double>(exact.size()));
  noisy.sensor_noise = Eigen::Vector3d::Constant(0.01 * rms);
  const auto ratio = [&](bool removed, Eigen::Index dropped) {
    const auto clean = virtual_experiment(transient_rig(), thesis_plan(), 1, 3);
    const auto data = virtual_experiment(noisy, thesis_plan(), 1, 3);
    const auto noise = frf_estimate(data, dropping(dropped)).set;
    // The estimator is linear in the outputs: what it makes of noiseless ones is its bias.
    const auto bias =
        frf_estimate(
            removed ? without_transient(clean, identification::start_at(beam()).pole).data : clean,
            dropping(dropped))
            .set;
    const auto truth = truth_of(bias);
    double largest = 0.0;
    for (std::size_t k = 0; k < truth.response.size(); ++k) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(bias.value[k](i, 0) - truth.response[k](i, 0)) /
                                        std::sqrt(noise.noise_variance[k](i, 0)));
      }
    }
    return largest;
  };
  EXPECT_GT(ratio(false, 1), 1.0);
  EXPECT_LT(ratio(true, 0), 0.1);
}

TEST(Transient, NoNoiseIsAddedByItsRemoval) {
  auto noisy = transient_rig();
  noisy.sensor_noise = Eigen::Vector3d::Constant(1e-6);
  const auto plan = thesis_plan();
  const auto data = virtual_experiment(noisy, plan, 1, 3);
  const auto clean = without_transient(virtual_experiment(transient_rig(), plan, 1, 3),
                                       identification::start_at(beam()).pole)
                         .data;
  const auto both = without_transient(data, identification::start_at(beam()).pole).data;
  const auto added = (both.records[0].outputs - clean.records[0].outputs).norm();
  const auto was = 1e-6 * std::sqrt(static_cast<double>(both.records[0].outputs.size()));
  EXPECT_NEAR(added / was, 1.0, 0.01);
}

TEST(Transient, IsNotSeenWhereThereIsNone) {
  auto quiet = rig_of(two_modes(), 512.0);
  quiet.sensor_noise = Eigen::Vector2d::Constant(1e-5);
  auto plan = plan_of_seconds(8);
  plan.warm_up = 12;
  int seen = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto report = transient(spectra(virtual_experiment(quiet, plan, 2, seed), 5.0, 80.0));
    seen += report.seen ? 1 : 0;
    EXPECT_GE(report.drop, 1);
  }
  EXPECT_LE(seen, 1);
}

TEST(Transient, RefusesPolesThatDoNotDecayAndSinglePeriods) {
  auto plan = plan_of_seconds(2);
  const auto data = virtual_experiment(rig_of(two_modes(), 512.0), plan, 1, 1);
  Eigen::VectorXcd pole(1);
  pole(0) = {1.0, 100.0};
  EXPECT_THROW((void)without_transient(data, pole), InvalidInput);
  pole(0) = {-1.0, 100.0};
  plan.periods = 1;
  EXPECT_THROW(
      (void)without_transient(virtual_experiment(rig_of(two_modes(), 512.0), plan, 1, 1), pole),
      InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
