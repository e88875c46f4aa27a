#include "identification/modal_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/draw.h"
#include "base/error.h"
#include "fit_errors.h"
#include "host/parallel.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

// The true poles, moved by a tenth of a bandwidth and their damping by a tenth.
Start near_truth(const modal::ReducedModel& truth, unsigned seed) {
  Draw draw(seed);
  Start start = start_at(truth);
  for (auto& pole : start.pole) {
    const double half = -pole.real();
    pole = {-half * std::exp(0.1 * draw.normal()), pole.imag() + 0.2 * half * draw.normal()};
  }
  return start;
}

FrfCase clean(FrfCase (*make)(const FrfFaults&)) {
  FrfFaults faults;
  faults.noisy = false;
  return make(faults);
}

void expect_exact(const FrfCase& made) {
  const auto exact = fit_data(made.measured);
  for (const double hertz : {1e-3, 1.0, 1e6}) {
    for (const double metre : {1.0, 1e6}) {
      FitData data = exact;  // in other units of time and length
      data.frequency_hz *= hertz;
      data.value *= metre / (hertz * hertz);
      data.weight /= metre / (hertz * hertz);
      auto start = near_truth(made.truth, 3);
      start.pole *= hertz;
      const auto fit = modal_fit(data, start);
      modal::ReducedModel truth = made.truth;
      truth.frequency_hz *= hertz;
      const auto errors = fit_errors(truth, fit);
      ASSERT_EQ(errors.missed, 0) << hertz << " " << metre;
      const auto n = errors.frequency_hz.size();
      const Eigen::ArrayXd frequency = truth.frequency_hz.tail(n);
      const Eigen::ArrayXd ratio = truth.damping_ratio.tail(n);
      EXPECT_LT((errors.frequency_hz.array() / frequency).abs().maxCoeff(), 1e-12);
      EXPECT_LT((errors.damping.array() / ratio).abs().maxCoeff(), 1e-10);
      EXPECT_LT(errors.damping.array().abs().maxCoeff(), 1e-12);
      EXPECT_GT(errors.mac.minCoeff(), 1.0 - 1e-12);
      EXPECT_LT((responses(fit, data.frequency_hz) - data.value).cwiseProduct(data.weight).norm(),
                1e-11 * data.value.cwiseProduct(data.weight).norm());
    }
  }
}

TEST(ModalFit, IsExactWithoutNoiseInAnyUnits) { expect_exact(clean(simulators::beam5x3)); }

TEST(ModalFit, IsExactWithRigidBodyModes) {
  FrfFaults faults;
  faults.noisy = false;
  expect_exact(simulators::big(5, 4, 9, 500, faults));
}

// The thesis' case: rigid-body modes as suspension modes. Stated deviations are the bound's.
TEST(ModalFit, StatesTheCramerRaoBound) {
  for (const auto& made : {simulators::beam5x3(), simulators::big(5, 4, 9, 800)}) {
    const auto bounds = simulators::cramer_rao(made);
    const auto fit = modal_fit(fit_data(made.measured), start_at(made.truth));
    const auto r = made.truth.rigid_count;
    ASSERT_EQ(fit.model.mode_count(), made.truth.mode_count());
    EXPECT_EQ(fit.parameter_count, bounds.parameters);
    const auto n = made.truth.mode_count() - r;
    const auto close = [](const Eigen::ArrayXXd& stated, const Eigen::ArrayXXd& bound) {
      return (stated / bound - 1.0).abs().maxCoeff();
    };
    EXPECT_LT(close(fit.frequency_std_hz.tail(n), bounds.frequency_hz.tail(n)), 0.03);
    EXPECT_LT(close(fit.damping_std.tail(n), bounds.damping.tail(n)), 0.03);
    // |L| = |R| in the fit, as they are in the truth of the bound.
    for (auto m = r; m < made.truth.mode_count(); ++m) {
      const double ratio =
          made.truth.output_shapes.col(m).norm() / made.truth.input_shapes.row(m).norm();
      EXPECT_LT(close(fit.output_std.col(m) * std::sqrt(ratio), bounds.outputs.col(m)), 0.05);
      EXPECT_LT(close(fit.input_std.row(m) / std::sqrt(ratio), bounds.inputs.row(m)), 0.05);
    }
    if (r > 0) {
      EXPECT_NEAR(fit.rigid_covariance.trace() / bounds.rigid_covariance.trace(), 1.0, 0.3);
    }
  }
}

struct Pair {
  double split, first, second;
  bool separable;
};

// T4: blocks turn into modes where the data can tell them; else the subspace is what is known.
TEST(ModalFit, TellsPairsApartOrSaysThatItCannot) {
  for (const auto& [split, first, second, separable] :
       {Pair{1e-2, 0.01, 0.01, true}, Pair{1e-3, 0.01, 0.01, true}, Pair{1e-4, 0.01, 0.01, false},
        Pair{0.0, 0.01, 0.01, false}, Pair{0.0, 0.01, 0.015, true}}) {
    SCOPED_TRACE(testing::Message() << split << " " << first << " " << second);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      FrfFaults faults;
      faults.seed = seed;
      const auto made = simulators::pairs(split, first, second, faults);
      const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, seed));
      ASSERT_EQ(fit.model.mode_count(), 4) << seed;
      EXPECT_LE(fit.iterations, 15) << seed;
      EXPECT_LT(std::abs(excess(fit)), 4.0) << seed;
      const Eigen::MatrixXd outputs = fit.model.output_shapes.middleCols(1, 2);
      const Eigen::MatrixXd truth = made.truth.output_shapes.middleCols(1, 2);
      EXPECT_LT(largest_sine(truth, outputs), 0.02) << seed;
      if (separable) {
        const Eigen::MatrixXd mac = modal::mac(truth, outputs);
        const double like =
            std::max(std::min(mac(0, 0), mac(1, 1)), std::min(mac(0, 1), mac(1, 0)));
        const double stated = fit.output_std.middleCols(1, 2).colwise().norm().maxCoeff() /
                              outputs.colwise().norm().minCoeff();
        EXPECT_GT(like, 1.0 - std::max(1e-4, 9.0 * stated * stated)) << seed;
        EXPECT_EQ(fit.groups.size(), 4U) << seed;
      } else {
        ASSERT_EQ(fit.groups.size(), 3U) << seed;
        EXPECT_EQ(fit.groups[1].size, 2) << seed;
      }
    }
  }
}

// T5: the bound holds from excellent to poor data.
TEST(ModalFit, IsEfficientAtAnyLevelOfNoise) {
  struct Level {
    double relative, floor;
  };
  for (const auto& [relative, floor] :
       {Level{1e-3, 0.0}, Level{0.05, 0.0}, Level{0.2, 0.0}, Level{0.0, 0.3}, Level{0.0, 3.0}}) {
    Eigen::ArrayXd frequency = Eigen::ArrayXd::Zero(5);
    Eigen::ArrayXd damping = Eigen::ArrayXd::Zero(5);
    constexpr int kSeeds = 60;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      FrfFaults faults;
      faults.relative_noise = relative;
      faults.floor_noise = floor;
      faults.seed = seed;
      const auto made = simulators::beam5x3(faults);
      static thread_local simulators::FrfBounds bounds;
      if (seed == 1) bounds = simulators::cramer_rao(made);
      const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, seed));
      const auto errors = fit_errors(made.truth, fit);
      ASSERT_EQ(errors.missed, 0) << relative << " " << floor << " seed " << seed;
      frequency += (errors.frequency_hz.array() / bounds.frequency_hz.array()).square() / kSeeds;
      damping += (errors.damping.array() / bounds.damping.array()).square() / kSeeds;
    }
    // Three deviations of a mean square of 60.
    EXPECT_GT(frequency.sqrt().minCoeff(), 0.72) << relative << " " << floor;
    EXPECT_LT(frequency.sqrt().maxCoeff(), 1.28) << relative << " " << floor;
    EXPECT_GT(damping.sqrt().minCoeff(), 0.72) << relative << " " << floor;
    EXPECT_LT(damping.sqrt().maxCoeff(), 1.28) << relative << " " << floor;
  }
}

TEST(ModalFit, FindsTheDelay) {
  for (const double samples : {0.0, 0.5, 2.0, 5.0}) {
    FrfFaults faults;
    faults.delay_s = samples / 4096.0;
    const auto made = simulators::beam5x3(faults);
    const auto bounds = simulators::cramer_rao(made, {.delay = true});
    FitOptions options;
    options.delay = true;
    const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, 1), options);
    EXPECT_NEAR(fit.delay_s, faults.delay_s, 3.0 * bounds.delay_s) << samples;
    EXPECT_NEAR(fit.delay_std_s / bounds.delay_s, 1.0, 0.05) << samples;
    EXPECT_LT(std::abs(excess(fit)), 4.0) << samples;
  }
}

// T8: what is missing has no weight, and no influence.
TEST(ModalFit, IgnoresWhatIsNotMeasured) {
  FrfFaults faults;
  faults.missing = 0.1;
  auto made = simulators::beam5x3(faults);
  const auto bounds = simulators::cramer_rao(made);
  const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, 1));
  const auto errors = fit_errors(made.truth, fit);
  ASSERT_EQ(errors.missed, 0);
  EXPECT_LT((errors.frequency_hz.array() / bounds.frequency_hz.array()).abs().maxCoeff(), 3.5);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_NEAR(static_cast<double>(fit.measured_count) / (2.0 * 799.0 * 15.0), 0.9, 0.02);
  FitData other = fit_data(made.measured);
  for (Eigen::Index i = 0; i < other.value.size(); ++i) {
    if (other.weight(i) == 0.0) other.value(i) = {1.0, -2.0};
  }
  const auto same = modal_fit(other, near_truth(made.truth, 1));
  EXPECT_LT((same.model.frequency_hz - fit.model.frequency_hz).norm(), 1e-9);
}

TEST(ModalFit, HoldsWithAChannelThatIsNotMeasured) {
  auto made = simulators::beam5x3();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) {
    line(1, 2) = {nan, nan};
    line.row(3).setConstant({nan, nan});
  }
  const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, 1));
  EXPECT_EQ(fit_errors(made.truth, fit).missed, 0);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_TRUE(fit.model.output_shapes.allFinite());
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_EQ(fit.output_std.row(i).allFinite(), i != 3);
  }
  EXPECT_TRUE(fit.input_std.allFinite());
  EXPECT_TRUE(fit.frequency_std_hz.allFinite());
  EXPECT_EQ(fit.model.output_shapes.row(3).norm(), 0.0);
  EXPECT_EQ(fit.output_std(3, 0), std::numeric_limits<double>::infinity());
}

// Its shape there is not known, which says nothing of whether the data separate two modes.
TEST(ModalFit, TellsAPairApartWithAChannelThatIsNotMeasured) {
  auto made = simulators::pairs(1e-2, 0.01, 0.01);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(3).setConstant({nan, nan});
  const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, 1));
  EXPECT_EQ(fit.output_std(3, 1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(fit.groups.size(), 4U);
}

TEST(ModalFit, KnowsADeadChannelAsZero) {
  FrfFaults faults;
  faults.output_gain = Eigen::VectorXd::Ones(5);
  faults.output_gain(2) = 0.0;
  const auto made = simulators::beam5x3(faults);
  const auto fit = modal_fit(fit_data(made.measured), near_truth(made.truth, 1));
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  const Eigen::ArrayXd dead = fit.model.output_shapes.row(2).transpose();
  EXPECT_LT((dead / fit.output_std.row(2).transpose().array()).abs().maxCoeff(), 4.0);
}

TEST(ModalFit, ScalesItsDeviationsWhereTheNoiseIsNotKnown) {
  const auto made = simulators::beam5x3();
  FitData data = fit_data(made.measured);
  const auto known = modal_fit(data, start_at(made.truth));
  data.noise_known = false;
  data.weight *= 17.0;
  const auto scaled = modal_fit(data, start_at(made.truth));
  EXPECT_LT(
      (scaled.frequency_std_hz.array() / known.frequency_std_hz.array() - 1.0).abs().maxCoeff(),
      0.03);
  EXPECT_LT((scaled.residual_std.array() / known.residual_std.array() - 1.0).abs().maxCoeff(),
            0.03);
}

TEST(ModalFit, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  const int before = thread_count();
  std::vector<ModalFit> fits;
  for (const int threads : {1, 2, 1}) {
    set_thread_count(threads);
    fits.push_back(modal_fit(data, near_truth(made.truth, 1)));
  }
  set_thread_count(before);
  for (const auto& fit : fits) {
    EXPECT_EQ(fit.model.frequency_hz, fits[0].model.frequency_hz);
    EXPECT_EQ(fit.model.output_shapes, fits[0].model.output_shapes);
    EXPECT_EQ(fit.damping_std, fits[0].damping_std);
    EXPECT_EQ(fit.cost, fits[0].cost);
  }
}

TEST(ModalFit, RefusesWhatDoesNotFitTogether) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  const auto good = start_at(made.truth);
  auto start = good;
  start.residue.resize(2);
  EXPECT_THROW((void)modal_fit(data, start), InvalidInput);
  start = good;
  start.pole(1) = {1.0, 30.0};
  EXPECT_THROW((void)modal_fit(data, start), InvalidInput);
  start = good;
  start.rigid_count = 4;
  EXPECT_THROW((void)modal_fit(data, start), InvalidInput);
  EXPECT_THROW((void)modal_fit(data, Start{}), InvalidInput);
  FitData few = data;
  few.weight.bottomRows(few.weight.rows() - 2).setZero();
  EXPECT_THROW((void)modal_fit(few, good), InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
