#include "recordings/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "modal/state_space.h"
#include "rotation/turn.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

// Two rigid-body modes and one at 70 Hz, three sensors, actuators 1 and 3 in a loop of 12 Hz.
modal::ReducedModel free_body() {
  Eigen::MatrixXd shapes(3, 3);
  shapes << 1.0, -1.2, 0.8, 1.0, 0.1, -0.9, 1.0, 1.3, 0.7;
  return model_of(Eigen::Vector3d(0.0, 0.0, 70.0), 0.02, shapes, shapes.transpose());
}

VirtualRig rig() {
  const auto model = free_body();
  auto result = rig_of(model, 1024.0);
  result.delay_s = result.sample_time_s;
  result.controller = stabiliser(model, 2, {0, 2}, 12.0, result.sample_time_s);
  return result;
}

VirtualExperimentPlan plan_of_1024(Eigen::Index periods) {
  VirtualExperimentPlan plan;
  plan.multisine.period = 1024;
  plan.multisine.sample_time_s = 1.0 / 1024.0;
  plan.multisine.low_hz = 2.0;
  plan.multisine.high_hz = 60.0;
  plan.periods = periods;
  plan.warm_up = 4;
  plan.scheme = InputScheme::orthogonal;
  return plan;
}

std::vector<Eigen::MatrixXcd> truth(const Eigen::VectorXd& hz) {
  const auto space = modal::discretised(modal::state_space(free_body()), 1.0 / 1024.0);
  std::vector<Eigen::MatrixXcd> result;
  for (const double f : hz) {
    result.emplace_back(modal::response(space, f) *
                        std::polar(1.0, -2.0 * std::numbers::pi * f / 1024.0));
  }
  return result;
}

FrfEstimateOptions all_periods() {
  FrfEstimateOptions options;
  options.drop = 0;
  options.smooth_lines = 0;
  return options;
}

TEST(ClosedLoop, IsExactWithoutNoise) {
  const auto data = virtual_experiment(rig(), plan_of_1024(1), 1, 1);
  const auto found = closed_loop_estimate(data, all_periods());
  const auto want = truth(found.estimate.set.frequency_hz);
  for (std::size_t k = 0; k < want.size(); ++k) {
    EXPECT_LT((found.estimate.set.value[k] - want[k]).norm(), 1e-6 * want[k].norm());
    // The input that is not controlled is its reference: [0 1 0] exactly.
    EXPECT_EQ(Eigen::RowVectorXcd(found.sensitivity[k].row(1)),
              Eigen::RowVectorXcd(Eigen::RowVectorXcd::Unit(3, 1)));
  }
}

constexpr int kExperiments = 30;

// Errors of repeated experiments on each line.
class Errors {
 public:
  void add(const modal::FrfSet& set) {
    if (want_.empty()) {
      want_ = truth(set.frequency_hz);
      sum_.assign(want_.size(), Eigen::MatrixXcd::Zero(3, 3));
      squares_.assign(want_.size(), Eigen::MatrixXd::Zero(3, 3));
    }
    for (std::size_t k = 0; k < want_.size(); ++k) {
      sum_[k] += set.value[k] - want_[k];
      squares_[k] += (set.value[k] - want_[k]).cwiseAbs2();
    }
  }
  // Root mean square over lines and responses, in deviations of one estimate; what a mean of so
  // many is off by itself taken away.
  [[nodiscard]] double bias() const {
    double square = 0.0;
    double count = 0.0;
    for (std::size_t k = 0; k < want_.size(); ++k) {
      for (Eigen::Index i = 0; i < 9; ++i) {
        const double mean = std::norm(sum_[k](i)) / (kExperiments * kExperiments);
        const double variance = (squares_[k](i) - kExperiments * mean) / (kExperiments - 1.0);
        square += mean / variance - 1.0 / kExperiments;
        count += 1.0;
      }
    }
    return std::sqrt(std::max(0.0, square / count));
  }

 private:
  std::vector<Eigen::MatrixXcd> sum_, want_;
  std::vector<Eigen::MatrixXd> squares_;
};

// Noise on the forces of 0.7 of the excitation: in the loop it reaches the inputs too.
TEST(ClosedLoop, TheIndirectEstimateIsUnbiasedWhereTheDirectOneIsNot) {
  EVERY_FOURTH_LANDING();
  auto noisy = rig();
  noisy.process_noise = Eigen::Vector3d(0.7, 0.7, 0.7);
  auto plan = plan_of_1024(1);
  plan.warm_up = 1;
  Errors indirect;
  Errors direct;
  for (unsigned seed = 1; seed <= kExperiments; ++seed) {
    const auto data = virtual_experiment(noisy, plan, 20, seed);
    indirect.add(closed_loop_estimate(data, all_periods()).estimate.set);
    direct.add(frf_estimate(data, all_periods()).set);
  }
  EXPECT_LT(indirect.bias(), 0.1);
  EXPECT_GT(direct.bias(), 0.4);
}

TEST(ClosedLoop, ItsVarianceIsTrue) {
  auto noisy = rig();
  noisy.process_noise = Eigen::Vector3d(0.3, 0.3, 0.3);
  noisy.sensor_noise = Eigen::Vector3d(1e-5, 1e-5, 1e-5);
  double squares = 0.0;
  double total = 0.0;
  double noise = 0.0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto set =
        closed_loop_estimate(virtual_experiment(noisy, plan_of_1024(3), 4, seed), all_periods())
            .estimate.set;
    const auto want = truth(set.frequency_hz);
    for (std::size_t k = 0; k < want.size(); ++k) {
      const Eigen::ArrayXXd size = want[k].cwiseAbs2().array();
      squares += ((set.value[k] - want[k]).cwiseAbs2().array() / size).sum();
      total += (set.variance[k].array() / size).sum();
      noise += (set.noise_variance[k].array() / size).sum();
    }
  }
  EXPECT_NEAR(squares / total, 1.0, 0.1);
  EXPECT_NEAR(squares / noise, 1.0, 0.1);
}

TEST(ClosedLoop, SaysWhereTheLoopTakesTheExcitationAway) {
  auto noisy = rig();
  noisy.process_noise = Eigen::Vector3d(30.0, 30.0, 30.0);
  const auto found = closed_loop_estimate(virtual_experiment(noisy, plan_of_1024(2), 3, 1));
  bool named = false;
  for (const auto& note : found.estimate.notes) {
    named = named || note.find("singular") != std::string::npos;
  }
  EXPECT_TRUE(named);
}

TEST(ClosedLoop, NeedsAReferenceForEachInput) {
  auto data = virtual_experiment(rig(), plan_of_1024(2), 1, 1);
  data.references.pop_back();
  for (auto& record : data.records) {
    record.references = Eigen::MatrixXd(record.references.leftCols(2));
  }
  EXPECT_THROW((void)closed_loop_estimate(data), InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
