#include "identification/identified.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "fit_errors.h"
#include "host/parallel.h"
#include "rotation/turn.h"
#include "simulators/frf_bounds.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

Identified found_in(const FrfCase& made, bool delay = false) {
  IdentificationOptions options;
  options.rigid_count = made.truth.rigid_count;
  options.fit.delay = delay;
  return identified(fit_data(made.measured), options);
}

// Mean squares of errors over the bound of many seeds, and how many 95 % intervals hold the truth.
struct Statistics {
  Eigen::ArrayXd frequency = Eigen::ArrayXd::Zero(5), damping = Eigen::ArrayXd::Zero(5);
  Eigen::Index held = 0, intervals = 0;
};

void add(const FitErrors& errors, const simulators::FrfBounds& bounds, double share,
         Statistics& all) {
  all.frequency += share * (errors.frequency_hz.array() / bounds.frequency_hz.array()).square();
  all.damping += share * (errors.damping.array() / bounds.damping.array()).square();
  for (const auto& [error, deviation] : {std::pair(errors.frequency_hz, errors.frequency_std_hz),
                                         std::pair(errors.damping, errors.damping_std)}) {
    all.held += (error.array().abs() < 1.96 * deviation.array()).count();
    all.intervals += error.size();
  }
}

// T2: 200 records of the beam at each level.
TEST(Identified, ReachesTheBoundOnTheBeam) {
  EVERY_FOURTH_LANDING();
  for (const double noise : {0.01, 0.1}) {
    constexpr unsigned kSeeds = 200;
    Statistics all;
    simulators::FrfBounds bounds;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      FrfFaults faults;
      faults.relative_noise = noise;
      faults.seed = seed;
      const auto made = simulators::beam5x3(faults);
      if (seed == 1) bounds = simulators::cramer_rao(made);
      const auto found = found_in(made);
      ASSERT_EQ(found.fit.model.mode_count(), 5) << noise << " seed " << seed;
      const auto errors = fit_errors(made.truth, found.fit);
      ASSERT_EQ(errors.missed, 0) << noise << " seed " << seed;
      add(errors, bounds, 1.0 / kSeeds, all);
    }
    const Eigen::ArrayXd frequency = all.frequency.sqrt();
    const Eigen::ArrayXd damping = all.damping.sqrt();
    EXPECT_GT(frequency.minCoeff(), 0.85) << frequency.transpose();
    EXPECT_LT(frequency.maxCoeff(), 1.15) << frequency.transpose();
    EXPECT_GT(damping.minCoeff(), 0.85) << damping.transpose();
    EXPECT_LT(damping.maxCoeff(), 1.15) << damping.transpose();
    const double covered = static_cast<double>(all.held) / static_cast<double>(all.intervals);
    EXPECT_GT(covered, 0.93) << noise;
    EXPECT_LT(covered, 0.97) << noise;
    RecordProperty(noise < 0.05 ? "covered_1" : "covered_10", std::to_string(covered));
  }
}

// T3: the wafer table.
TEST(Identified, FindsTheModesOfTheTable) {
  const auto made = simulators::oat4x13();
  const auto bounds = simulators::cramer_rao(made);
  const auto found = found_in(made);
  ASSERT_EQ(found.fit.model.mode_count(), 20);
  const auto errors = fit_errors(made.truth, found.fit);
  ASSERT_EQ(errors.missed, 0);
  EXPECT_LT((errors.frequency_hz.array() / bounds.frequency_hz.tail(17).array()).abs().maxCoeff(),
            3.0);
  EXPECT_LT((errors.damping.array() / bounds.damping.tail(17).array()).abs().maxCoeff(), 3.0);
  EXPECT_GT(errors.mac.minCoeff(), 0.9999);
  EXPECT_LT(std::abs(excess(found.fit)), 3.5);
}

TEST(Identified, FindsTheNumberOfRigidBodyModes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    const auto free = simulators::big(6, 5, 9, 800, faults);
    IdentificationOptions options;
    options.rigid_count = -1;
    const auto found = identified(fit_data(free.measured), options);
    EXPECT_EQ(found.fit.model.rigid_count, 3) << seed;
    EXPECT_EQ(found.fit.model.mode_count(), 9) << seed;
    // Bodies on a suspension have none.
    const auto held = simulators::beam5x3(faults);
    const auto none = identified(fit_data(held.measured), options);
    EXPECT_EQ(none.fit.model.rigid_count, 0) << seed;
    EXPECT_EQ(fit_errors(held.truth, none.fit).missed, 0) << seed;
  }
}

// The table on springs at 1.5 to 2.5 Hz, 30 times below the lines and more: the flank of these
// modes is that of modes at 0 Hz, but for a tenth of the noise.
FrfCase table_on_springs() {
  auto truth = simulators::part(simulators::oat4x13(), {0, 1, 2, 3}, {0, 4, 9}).truth;
  truth.rigid_count = 0;
  truth.frequency_hz.head<3>() << 1.5, 2.0, 2.5;
  truth.damping_ratio.head<3>().setConstant(0.006);
  Eigen::MatrixX3d sensors = Eigen::MatrixX3d::Zero(4, 3);
  Eigen::MatrixX3d actuators = Eigen::MatrixX3d::Zero(3, 3);
  sensors.col(0) = Eigen::Vector4d(1.0, 2.0, 3.0, 4.0);
  actuators.col(0) = Eigen::Vector3d(1.5, 2.5, 3.5);
  return simulators::frf_case(
      truth, {sensors, actuators, Eigen::VectorXd::LinSpaced(2321, 80.0, 2400.0)}, {});
}

TEST(Identified, TakesASuspensionFarBelowTheLinesForRigidBodyModes) {
  EVERY_FOURTH_LANDING();
  const auto made = table_on_springs();
  IdentificationOptions options;
  options.on_springs = true;
  const auto found = identified(fit_data(made.measured), options);
  EXPECT_LT(std::abs(excess(found.fit)), 4.0);
  EXPECT_EQ(found.fit.model.rigid_count, 3);
  EXPECT_EQ(found.fit.model.mode_count(), made.truth.mode_count());
  for (Eigen::Index m = 3; m < made.truth.mode_count(); ++m) {
    const double hz = made.truth.frequency_hz(m);
    EXPECT_LT((found.fit.model.frequency_hz.array() - hz).abs().minCoeff(), 2e-4 * hz) << hz;
  }
  options.on_springs = false;
  EXPECT_GT(identified(fit_data(made.measured), options).fit.excess(), 100.0);
}

// A suspension among the lines is found as before.
TEST(Identified, TellsModesOfASuspensionAmongTheLines) {
  const auto made = simulators::beam5x3();
  IdentificationOptions options;
  const auto plain = identified(fit_data(made.measured), options);
  options.on_springs = true;
  const auto found = identified(fit_data(made.measured), options);
  EXPECT_EQ(found.fit.model.frequency_hz, plain.fit.model.frequency_hz);
  EXPECT_EQ(found.fit.cost, plain.fit.cost);
}

// T4, the number of modes not given: also half of a pair that the vector fit does not see.
TEST(Identified, FindsBothModesOfAPair) {
  for (const double split : {1e-2, 1e-3, 1e-4, 0.0}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      FrfFaults faults;
      faults.seed = seed;
      const auto made = simulators::pairs(split, 0.01, 0.01, faults);
      const auto found = found_in(made);
      EXPECT_EQ(found.fit.model.mode_count(), 4) << split << " seed " << seed;
      if (found.fit.model.mode_count() != 4) continue;
      EXPECT_LT(std::abs(excess(found.fit)), 4.0) << split << " seed " << seed;
      EXPECT_LT(largest_sine(made.truth.output_shapes.middleCols(1, 2),
                             found.fit.model.output_shapes.middleCols(1, 2)),
                0.02)
          << split << " seed " << seed;
    }
  }
}

// T6: poles and delay of a record that is 0 to 5 samples late, without a first guess.
TEST(Identified, FindsADelayOfSamples) {
  for (const double samples : {0.0, 1.0, 3.3, 5.0}) {
    FrfFaults faults;
    faults.delay_s = samples / 4096.0;
    const auto made = simulators::beam5x3(faults);
    const auto bounds = simulators::cramer_rao(made, {.delay = true});
    const auto found = found_in(made, true);
    EXPECT_NEAR(found.fit.delay_s, faults.delay_s, 2.0 * bounds.delay_s) << samples;
    const auto errors = fit_errors(made.truth, found.fit);
    ASSERT_EQ(errors.missed, 0) << samples;
    EXPECT_LT((errors.damping.array() / bounds.damping.array()).abs().maxCoeff(), 3.5) << samples;
  }
}

// T9: a mode 7 % above the band is seen by what it leaves, and taken.
TEST(Identified, AbsorbsAModeAboveTheBand) {
  FrfFaults faults;
  faults.out_of_band = 0.07;
  const auto made = simulators::beam5x3(faults);
  const auto bounds = simulators::cramer_rao(made);
  const auto constant = modal_fit(fit_data(made.measured), [&] {
    auto start = start_at(made.truth);
    start.pole.conservativeResize(5);
    return start;
  }());
  EXPECT_GT(excess(constant), 5.0);
  const auto found = found_in(made);
  EXPECT_LT(std::abs(excess(found.fit)), 4.0);
  const auto errors = fit_errors(made.truth, found.fit);
  EXPECT_LT((errors.frequency_hz.array() / bounds.frequency_hz.array()).head(5).abs().maxCoeff(),
            3.0);
  EXPECT_LT((errors.damping.array() / bounds.damping.array()).head(5).abs().maxCoeff(), 3.5);
}

// T15: a dashpot at one place makes the modes complex; real ones of the same number are rejected.
TEST(Identified, RejectsRealModesWhereTheyAreComplex) {
  FrfFaults faults;
  faults.dashpot = 1.0;
  const auto made = simulators::beam5x3(faults);
  IdentificationOptions options;
  options.modes = 5;
  const auto fit = identified(fit_data(made.measured), options).fit;
  EXPECT_GT(excess(fit), 5.0);
  // Poles of real modes are still within a part of the bandwidth.
  const auto truth = simulators::complex_modes(made.truth);
  for (Eigen::Index m = 2; m < 5; ++m) {
    const double own = 2.0 * std::numbers::pi * fit.model.frequency_hz(m);
    EXPECT_NEAR(own, std::abs(truth.pole(m)), -truth.pole(m).real()) << m;
  }
}

// As many complex ones are found, and fit to the noise; with a delay, that phases could be too.
TEST(Identified, FindsComplexModesWhereTheyAre) {
  EVERY_FOURTH_LANDING();
  for (const double samples : {0.0, 2.0}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      FrfFaults faults;
      faults.dashpot = 1.0;
      faults.seed = seed;
      faults.delay_s = samples / 4096.0;
      const auto made = simulators::beam5x3(faults);
      IdentificationOptions options;
      options.fit.damping = Damping::general;
      options.fit.delay = samples > 0.0;
      const auto fit = identified(fit_data(made.measured), options).fit;
      ASSERT_EQ(fit.model.mode_count(), 5) << samples << " seed " << seed;
      ASSERT_TRUE(fit.complex);
      EXPECT_LT(std::abs(excess(fit)), 4.0) << samples << " seed " << seed;
      EXPECT_NEAR(fit.delay_s, faults.delay_s, 3e-5) << seed;
      EXPECT_LE(std::abs(fit.delay_s - faults.delay_s), fit.delay_std_s) << seed;
      const auto truth = simulators::complex_modes(made.truth);
      for (Eigen::Index m = 0; m < 5; ++m) {
        EXPECT_NEAR(2.0 * std::numbers::pi * fit.model.frequency_hz(m), std::abs(truth.pole(m)),
                    4.0 * 2.0 * std::numbers::pi * fit.frequency_std_hz(m))
            << m << " seed " << seed;
      }
    }
  }
}

TEST(Identified, FindsTheModesOfAFreePlateWithGeneralDamping) {
  const auto made = simulators::big(6, 5, 9, 800);
  IdentificationOptions options;
  options.rigid_count = -1;
  options.fit.damping = Damping::general;
  const auto fit = identified(fit_data(made.measured), options).fit;
  EXPECT_EQ(fit.model.rigid_count, 3);
  ASSERT_EQ(fit.model.mode_count(), 9);
  EXPECT_EQ(fit_errors(made.truth, fit).missed, 0);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
}

// T8: 10 % of the values missing, a row not measured, a dead channel.
TEST(Identified, HoldsWithGapsAndDeadChannels) {
  FrfFaults faults;
  faults.missing = 0.1;
  faults.output_gain = Eigen::VectorXd::Ones(5);
  faults.output_gain(1) = 0.0;
  faults.output_gain(4) = -1.1;
  auto made = simulators::beam5x3(faults);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(3).setConstant({nan, nan});
  made.measured.value[100].setConstant({nan, nan});
  const auto found = found_in(made);
  EXPECT_EQ(found.fit.model.mode_count(), 5);
  EXPECT_LT(std::abs(excess(found.fit)), 4.0);
  for (Eigen::Index m = 0; m < 5; ++m) {
    EXPECT_NEAR(found.fit.model.frequency_hz(m), made.truth.frequency_hz(m),
                5.0 * found.fit.frequency_std_hz(m));
  }
}

TEST(Identified, TakesAsManyModesAsAreAskedFor) {
  const auto made = simulators::beam5x3();
  for (const Eigen::Index modes : {3, 5, 6}) {
    IdentificationOptions options;
    options.modes = modes;
    EXPECT_EQ(identified(fit_data(made.measured), options).fit.model.mode_count(), modes);
  }
}

TEST(Identified, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto made = simulators::beam5x3();
  const auto data = fit_data(made.measured);
  const int before = thread_count();
  std::vector<ModalFit> fits;
  for (const int threads : {1, 2, 1}) {
    set_thread_count(threads);
    fits.push_back(identified(data).fit);
  }
  set_thread_count(before);
  for (const auto& fit : fits) {
    EXPECT_EQ(fit.model.frequency_hz, fits[0].model.frequency_hz);
    EXPECT_EQ(fit.model.output_shapes, fits[0].model.output_shapes);
    EXPECT_EQ(fit.damping_std, fits[0].damping_std);
  }
}

TEST(Identified, SaysThatNoiseHoldsNoMode) {
  FrfFaults faults;
  faults.floor_noise = 1e9;
  const auto made = simulators::beam5x3(faults);
  EXPECT_THROW((void)identified(fit_data(made.measured)), InvalidInput);
}

// The same data leave the modes where they are; a delay of the data comes back.
TEST(Refitted, StaysWhereTheFitWas) {
  FrfFaults faults;
  faults.relative_noise = 0.01;
  auto made = simulators::beam5x3(faults);
  const auto found = found_in(made, true);
  FitOptions options;
  options.delay = true;
  const auto again = refitted(fit_data(made.measured), found.fit, options);
  const auto& before = found.fit.model;
  ASSERT_EQ(again.model.mode_count(), before.mode_count());
  EXPECT_LT(((again.model.frequency_hz - before.frequency_hz).array() /
             found.fit.frequency_std_hz.array())
                .abs()
                .maxCoeff(),
            0.02);
  EXPECT_NEAR(again.delay_s, found.fit.delay_s, 0.02 * found.fit.delay_std_s);
}

TEST(TakeValues, KeepsDeviationsAndHowShapesAreTurned) {
  auto into = found_in(simulators::beam5x3({}), false).fit;
  const auto before = into;
  auto from = into;
  from.model.frequency_hz *= 1.001;
  from.model.output_shapes *= -1.002;
  from.model.input_shapes *= -1.002;
  from.frequency_std_hz *= 7.0;
  take_values(from, into);
  EXPECT_EQ(into.model.frequency_hz, from.model.frequency_hz);
  EXPECT_EQ(into.model.output_shapes, -from.model.output_shapes);
  EXPECT_EQ(into.model.input_shapes, -from.model.input_shapes);
  EXPECT_EQ(into.frequency_std_hz, before.frequency_std_hz);
}

// A sensor whose values say nothing does not say how a shape is turned either.
TEST(TakeValues, TurnsShapesByWhatIsKnown) {
  ModalFit into;
  into.model.frequency_hz = into.model.damping_ratio = Eigen::VectorXd::Ones(1);
  into.model.output_shapes = Eigen::Vector2d(1.0, -5.0);
  into.model.input_shapes = Eigen::MatrixXd::Ones(1, 1);
  into.output_std = Eigen::Vector2d(0.1, std::numeric_limits<double>::infinity());
  auto from = into;
  from.model.output_shapes(1) = 5.0;
  take_values(from, into);
  EXPECT_EQ(into.model.output_shapes.col(0), Eigen::Vector2d(1.0, 5.0));
}

}  // namespace
}  // namespace chladni::identification
