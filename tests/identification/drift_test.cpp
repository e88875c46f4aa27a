// Responses measured one after the other while the structure changed.
#include "identification/poles/drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/draw.h"
#include "fit_errors.h"
#include "identification/identified.h"
#include "modal/frf.h"
#include "rotation/turn.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

// The beam, damped little, each response with its resonances moved; noise that is not stated.
struct Moved {
  modal::ReducedModel truth;
  Eigen::VectorXd shift;  // about 0
  FitData data;
};

Moved moved_beam(double by, unsigned seed) {
  simulators::FrfFaults faults;
  faults.noisy = false;
  Moved result{simulators::beam5x3(faults).truth, Eigen::VectorXd(15), {}};
  auto set = simulators::beam5x3(faults).measured;
  result.truth.damping_ratio *= 0.25;
  Draw draw(seed);
  for (double& shift : result.shift) shift = by * draw.normal();
  result.shift.array() -= result.shift.mean();
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < 5; ++i) {
      const auto frf = modal::frf(result.truth, set.frequency_hz / (1.0 + result.shift(i + 5 * j)));
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        const double size = 0.005 * std::abs(frf.value[k](i, j)) + 1e-7;
        const double real = draw.normal();
        set.value[k](i, j) =
            frf.value[k](i, j) + size * std::sqrt(0.5) * std::complex<double>(real, draw.normal());
      }
    }
  }
  set.variance.clear();
  result.data = fit_data(set, {.model_error = 0.01});
  return result;
}

TEST(Drift, IsTakenOutOfTheData) {
  const auto made = moved_beam(0.0, 1);
  ModalFit fit;
  fit.model = made.truth;
  FitData exact = made.data;
  exact.value = responses(fit, exact.frequency_hz);
  FitData later = exact;
  const Eigen::VectorXd shift = Eigen::VectorXd::LinSpaced(15, -3e-3, 3e-3);
  for (Eigen::Index e = 0; e < 15; ++e) {
    later.value.col(e) = responses(fit, exact.frequency_hz / (1.0 + shift(e))).col(e);
  }
  EXPECT_GT((later.value - exact.value).norm(), 0.1 * exact.value.norm());
  EXPECT_LT((without_drift(later, fit, shift).value - exact.value).norm(),
            1e-12 * exact.value.norm());
}

TEST(Drift, IsFoundToItsDeviations) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto made = moved_beam(6e-4, seed);
    const auto [drift, fit] = drift_fit(made.data, start_at(made.truth), {});
    EXPECT_TRUE(drift.matters()) << drift.change << ' ' << drift.excess;
    const Eigen::ArrayXd information = drift.deviation.array().square().inverse();
    const double mean = (information * made.shift.array()).sum() / information.sum();
    const Eigen::ArrayXd off = drift.shift.array() - (made.shift.array() - mean);
    EXPECT_LT((off / drift.deviation.array()).abs().maxCoeff(), 5.0) << seed;
    EXPECT_LT(off.abs().maxCoeff(), 1e-4) << seed;
    for (Eigen::Index m = 0; m < 5; ++m) {
      EXPECT_NEAR(fit.model.frequency_hz(m), made.truth.frequency_hz(m) * (1.0 + mean),
                  5.0 * fit.frequency_std_hz(m))
          << m << " seed " << seed;
      EXPECT_NEAR(fit.model.damping_ratio(m), made.truth.damping_ratio(m),
                  5.0 * fit.damping_std(m) + 0.02 * made.truth.damping_ratio(m))
          << m << " seed " << seed;
    }
  }
}

TEST(Drift, DoesNotDependOnTheUnits) {
  const auto made = moved_beam(6e-4, 1);
  const auto one = drift_fit(made.data, start_at(made.truth), {}).drift;
  auto other = made.data;
  other.frequency_hz *= 1e3;
  other.value *= 1e-3;
  other.weight *= 1e3;
  auto start = start_at(made.truth);
  start.pole *= 1e3;
  const auto scaled = drift_fit(other, start, {}).drift;
  EXPECT_LT((scaled.shift - one.shift).norm(), 1e-6 * one.shift.norm());
  EXPECT_NEAR(scaled.change, one.change, 1e-6 * one.change);
}

// Sensors that were not measured say nothing of a drift, and dilute none.
TEST(Drift, IsThatOfTheMeasuredResponses) {
  const auto made = moved_beam(6e-5, 2);
  FitData wider = made.data;
  wider.outputs = 8;
  wider.value.setZero(made.data.line_count(), 24);
  wider.weight.setZero(made.data.line_count(), 24);
  std::vector<Eigen::Index> measured;
  for (Eigen::Index e = 0; e < 15; ++e) measured.push_back(e % 5 + 8 * (e / 5));
  wider.value(Eigen::all, measured) = made.data.value;
  wider.weight(Eigen::all, measured) = made.data.weight;
  const auto own = drift_fit(made.data, start_at(made.truth), {}).drift;
  const auto found = drift_fit(wider, start_at(made.truth), {}).drift;
  EXPECT_NEAR(found.excess, own.excess, 0.01 * own.excess);
  EXPECT_LT((found.shift(measured) - own.shift).norm(), 0.01 * own.shift.norm());
}

// Each resonance is one mode, where each would be several without.
TEST(Drift, IsNotTakenForModes) {
  EVERY_FOURTH_LANDING();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto made = moved_beam(4e-4, seed);
    IdentificationOptions options;
    const auto found = identified(made.data, options);
    ASSERT_TRUE(found.drift) << seed;
    EXPECT_EQ(found.fit.model.mode_count(), 5) << seed;
    options.drift = false;
    EXPECT_GT(identified(made.data, options).fit.model.mode_count(), 5) << seed;
  }
}

// Resonances of one sensor that lie far from the others' look like modes of their own, and a fit
// with twice the modes always leaves a little less.
TEST(Drift, OfOneSensorIsNoModesHoweverLarge) {
  modal::ReducedModel truth;
  truth.frequency_hz = Eigen::Vector4d(33.0, 93.0, 184.0, 300.0);
  truth.damping_ratio = Eigen::Vector4d(0.008, 0.006, 0.01, 0.007);
  Draw draw(1);
  truth.output_shapes = Eigen::MatrixXd::NullaryExpr(3, 4, [&] { return draw.normal(); });
  truth.input_shapes = truth.output_shapes.topRows(2).transpose();
  truth.residual = Eigen::MatrixXd::Zero(3, 2);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(781, 10.0, 400.0);
  const auto still = modal::frf(truth, lines);
  for (const double by : {2e-3, 4e-3, 8e-3}) {
    const auto moved = modal::frf(truth, lines / (1.0 + by));
    auto set = part(simulators::beam5x3(), {0, 1, 4}, {0, 1}).measured;
    set.frequency_hz = lines;
    set.value = still.value;
    set.variance.clear();
    set.noise_variance.clear();
    double size = 0.0;
    for (const auto& value : still.value) size += value.cwiseAbs().mean() / 781.0;
    for (std::size_t k = 0; k < set.value.size(); ++k) {
      set.value[k].row(2) = moved.value[k].row(2);
      for (auto& value : set.value[k].reshaped()) {
        const double real = draw.normal();
        value += 0.007 * size * std::complex<double>(real, draw.normal());
      }
    }
    const auto found = identified(fit_data(set, {.model_error = 0.01}));
    EXPECT_TRUE(found.drift) << by;
    EXPECT_EQ(found.fit.model.mode_count(), 4) << by;
  }
}

TEST(Drift, IsNotSeenWhereThereIsNone) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto made = moved_beam(0.0, seed);
    const auto found = identified(made.data);
    EXPECT_FALSE(found.drift) << seed;
    EXPECT_EQ(found.fit.model.mode_count(), 5) << seed;
  }
}

// Two modes within a bandwidth move the resonance from response to response too, but all others
// stay.
TEST(Drift, IsNotAPairOfModes) {
  for (const double split : {0.06, 0.04, 0.03}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      simulators::FrfFaults faults;
      faults.seed = seed;
      auto made = simulators::part(simulators::pairs(split, 0.01, 0.01, faults), {0}, {0, 1, 2});
      made.measured.variance.clear();
      const auto found = identified(fit_data(made.measured, {.model_error = 0.01}));
      EXPECT_FALSE(found.drift) << split << " seed " << seed;
      EXPECT_EQ(found.fit.model.mode_count(), 4) << split << " seed " << seed;
    }
  }
}

TEST(Drift, IsNotLookedForWhereVariancesAreStated) {
  auto made = moved_beam(1e-3, 1);
  made.data.noise_stated = true;
  EXPECT_FALSE(identified(made.data).drift);
}

}  // namespace
}  // namespace chladni::identification
