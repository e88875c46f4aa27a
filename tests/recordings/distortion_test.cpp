// A chain of three masses, the first held by a hardening spring, driven by random-phase multisines:
// what the estimates say of its distortion, and of the poles of its best linear approximation. The
// chain is integrated here (Runge and Kutta), not by the virtual laboratory.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "base/draw.h"
#include "base/turn.h"
#include "identification/fit_data.h"
#include "identification/modal_fit.h"
#include "recordings/frf_estimate.h"
#include "rotation/turn.h"
#include "tests/recordings/rigs.h"

namespace chladni::recordings {
namespace {

constexpr Eigen::Index kSamples = 1024, kSubsteps = 8, kFirstLine = 16, kLastLine = 352;
constexpr Eigen::Index kFine = 2 * kSubsteps * kSamples;  // half steps of a period
constexpr double kPeriod = 16.0;                          // [s]
constexpr double kStiffness = 4000.0, kMass = 1.0;        // [N/m], [kg], each of the chain
constexpr double kOfMass = 1.0, kOfStiffness = 4e-4;      // Rayleigh damping [1/s], [s]
constexpr double kAmplitude = 1.0;                        // of each line [N]
constexpr int kWarmUp = 2, kPeriodsOfDistortion = 3, kRealisationsOfDistortion = 10, kTruth = 200,
              kExperimentsOfDistortion = 6;

using State = Eigen::Matrix<double, 6, 1>;  // places, speeds

State rate(const State& at, double force, double cubic) {
  static const Eigen::Matrix3d kChain =
      kStiffness * Eigen::Matrix3d{{2.0, -1.0, 0.0}, {-1.0, 2.0, -1.0}, {0.0, -1.0, 1.0}};
  State result;
  result.head<3>() = at.tail<3>();
  result.tail<3>() =
      -kChain * (at.head<3>() + kOfStiffness * at.tail<3>()) / kMass - kOfMass * at.tail<3>();
  result(3) -= cubic * at(0) * at(0) * at(0) / kMass;
  result(4) += force / kMass;
  return result;
}

// One period of a random-phase multisine at half steps of the integration.
Eigen::VectorXd drawn_force(Draw& draw) {
  static const Eigen::VectorXd kCosine = [] {
    Eigen::VectorXd table(kFine);
    for (Eigen::Index n = 0; n < kFine; ++n) {
      table(n) = std::cos(kTwoPi * static_cast<double>(n) / static_cast<double>(kFine));
    }
    return table;
  }();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(kFine);
  for (auto k = kFirstLine; k <= kLastLine; ++k) {
    auto at = static_cast<Eigen::Index>(draw.uniform() * static_cast<double>(kFine));
    for (Eigen::Index n = 0; n < kFine; ++n) {
      force(n) += kAmplitude * kCosine(at);
      at = (at + k) % kFine;
    }
  }
  return force;
}

struct Steady {
  Eigen::MatrixXd input, outputs;  // N×1, N×2: one period
};

// The last of some periods: what is left of the start is 1e-9.
Steady steady(double cubic, Draw& draw) {
  const auto force = drawn_force(draw);
  constexpr double kStep = kPeriod / static_cast<double>(kSamples * kSubsteps);
  Steady result{Eigen::MatrixXd(kSamples, 1), Eigen::MatrixXd(kSamples, 2)};
  State x = State::Zero();
  for (int period = 0; period <= kWarmUp; ++period) {
    for (Eigen::Index n = 0; n < kSamples * kSubsteps; ++n) {
      if (n % kSubsteps == 0) {
        result.input(n / kSubsteps, 0) = force(2 * n);
        result.outputs.row(n / kSubsteps) << x(0), x(2);
      }
      const double middle = force(2 * n + 1);
      const State k1 = rate(x, force(2 * n), cubic);
      const State k2 = rate(x + 0.5 * kStep * k1, middle, cubic);
      const State k3 = rate(x + 0.5 * kStep * k2, middle, cubic);
      const State k4 = rate(x + kStep * k3, force((2 * n + 2) % force.size()), cubic);
      x += kStep / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
  }
  return result;
}

TimeData records(double cubic, double noise, int realisations, int periods, Draw& draw) {
  TimeData data;
  data.outputs = channels("y", 2);
  data.inputs = channels("u", 1);
  data.sample_time_s = kPeriod / kSamples;
  data.period = kSamples;
  for (int r = 0; r < realisations; ++r) {
    const auto one = steady(cubic, draw);
    Record record{one.outputs.replicate(periods, 1), one.input.replicate(periods, 1),
                  Eigen::MatrixXd(periods * kSamples, 0), 0, r};
    for (double& value : record.outputs.reshaped()) value += noise * draw.normal();
    data.records.push_back(std::move(record));
  }
  return data;
}

modal::FrfSet estimated(const TimeData& data, std::optional<Eigen::Index> smooth_lines) {
  FrfEstimateOptions options;
  options.drop = 0;
  options.smooth_lines = smooth_lines;
  options.low_hz = kFirstLine / kPeriod;
  options.high_hz = kLastLine / kPeriod;
  return frf_estimate(data, options).set;
}

constexpr double kCubic = 7e4;   // [N/m³]
constexpr double kNoise = 1e-5;  // [m]

// Variance of one realisation without noise, and the mean: from many others.
class Distortion : public testing::Test {
 protected:
  void SetUp() override {
    EVERY_FOURTH_LANDING();
    if (!data.empty()) return;
    Draw draw(17);
    truth = estimated(records(kCubic, 0.0, kTruth, 1, draw), 0);
    for (int n = 0; n < kExperimentsOfDistortion; ++n) {
      data.push_back(
          records(kCubic, kNoise, kRealisationsOfDistortion, kPeriodsOfDistortion, draw));
    }
  }
  static inline modal::FrfSet truth;
  static inline std::vector<TimeData> data;
};

// Over the linear response, both of one realisation [dB].
double level(const modal::FrfSet& truth) {
  double distortion = 0.0;
  double linear = 0.0;
  for (std::size_t k = 0; k < truth.value.size(); ++k) {
    distortion += kTruth * truth.variance[k].sum();
    linear += truth.value[k].squaredNorm();
  }
  return 10.0 * std::log10(distortion / linear);
}

TEST_F(Distortion, OfMinusFortyDecibelsIsFoundWithinADecibel) {
  EXPECT_NEAR(level(truth), -40.0, 2.0);
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (std::size_t third = 0; third < 3; ++third) {
      double found = 0.0;
      double count = 0.0;
      for (const auto& experiment : data) {
        const auto set = estimated(experiment, 0);
        const auto lines = set.value.size();
        for (auto k = third * lines / 3; k < (third + 1) * lines / 3; ++k) {
          const double one = kTruth * truth.variance[k](i, 0);  // of one realisation
          found +=
              kRealisationsOfDistortion * (set.variance[k] - set.noise_variance[k])(i, 0) / one;
          count += 1.0;
        }
      }
      EXPECT_LT(std::abs(10.0 * std::log10(found / count)), 1.0) << "y" << i << ", " << third;
    }
  }
}

// Errors over deviations of frequencies and damping ratios, root mean square over all experiments.
double pole_errors(const std::vector<Eigen::Index>& outputs, const modal::FrfSet& truth,
                   const std::vector<TimeData>& data) {
  const auto start = model_of(Eigen::Vector3d(4.48, 12.55, 18.13), 0.02, Eigen::MatrixXd(2, 3),
                              Eigen::MatrixXd(3, 1));
  const auto fit_of = [&](const modal::FrfSet& set) {
    return identification::modal_fit(identification::fit_data(modal::part(set, outputs, {0})),
                                     identification::start_at(start));
  };
  const auto exact = fit_of(truth);
  double squares = 0.0;
  for (const auto& experiment : data) {
    const auto fit = fit_of(estimated(experiment, std::nullopt));
    for (Eigen::Index m = 0; m < 3; ++m) {
      const double frequency = (fit.model.frequency_hz(m) - exact.model.frequency_hz(m)) /
                               std::hypot(fit.frequency_std_hz(m), exact.frequency_std_hz(m));
      const double damping = (fit.model.damping_ratio(m) - exact.model.damping_ratio(m)) /
                             std::hypot(fit.damping_std(m), exact.damping_std(m));
      EXPECT_LT(std::abs(frequency), 4.0) << m;
      EXPECT_LT(std::abs(damping), 4.0) << m;
      squares += frequency * frequency + damping * damping;
    }
  }
  return std::sqrt(squares / (6.0 * kExperimentsOfDistortion));
}

TEST_F(Distortion, PolesOfTheBestLinearApproximationLieWithinTheirDeviations) {
  for (const Eigen::Index output : {0, 1}) {
    EXPECT_NEAR(pole_errors({output}, truth, data), 1.0, 0.3) << output;
  }
  // What one spring distorts is in both outputs, the fit takes it for independent: their deviations
  // are too small by the root of two at most.
  EXPECT_LT(pole_errors({0, 1}, truth, data), 1.25 * std::sqrt(2.0));
}

}  // namespace
}  // namespace chladni::recordings
