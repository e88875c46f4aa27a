// Which simulated mode is which measured one: laws of the pairing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/compare.h"
#include "modal/pairing.h"
#include "simulators/frf_cases.h"

namespace chladni::diagnosis {
namespace {

using Indices = std::vector<Eigen::Index>;

const modal::ReducedModel& truth() {
  static const auto made = [] {
    simulators::FrfFaults faults;
    faults.noisy = false;
    return simulators::oat4x13(faults).truth;
  }();
  return made;
}

modal::ReducedModel modes_of(const modal::ReducedModel& of, const Indices& kept) {
  auto result = of;
  result.frequency_hz = of.frequency_hz(kept);
  result.damping_ratio = of.damping_ratio(kept);
  result.output_shapes = of.output_shapes(Eigen::all, kept);
  result.input_shapes = of.input_shapes(kept, Eigen::all);
  return result;
}

modal::ReducedModel channels_of(const modal::ReducedModel& of, const Indices& outputs,
                                const Indices& inputs) {
  auto result = of;
  result.output_shapes = of.output_shapes(outputs, Eigen::all);
  result.input_shapes = of.input_shapes(Eigen::all, inputs);
  result.residual = of.residual(outputs, inputs);
  return result;
}

// Deviations of a hundredth of the shapes' size.
identification::ModalFit fit_of(const modal::ReducedModel& model) {
  identification::ModalFit fit;
  fit.model = model;
  fit.frequency_std_hz = Eigen::VectorXd::Constant(model.mode_count(), 0.01);
  fit.damping_std = Eigen::VectorXd::Constant(model.mode_count(), 1e-4);
  fit.output_std = Eigen::MatrixXd::Constant(model.output_count(), model.mode_count(),
                                             0.01 * model.output_shapes.cwiseAbs().mean());
  fit.input_std = Eigen::MatrixXd::Constant(model.mode_count(), model.input_count(),
                                            0.01 * model.input_shapes.cwiseAbs().mean());
  return fit;
}

// As a fit would find it: shapes off by a twentieth, frequencies by a few per cent.
modal::ReducedModel nearly(modal::ReducedModel model, unsigned seed) {
  std::mt19937 dice(seed);
  std::normal_distribution<double> normal;
  const double outputs = 0.05 * model.output_shapes.cwiseAbs().mean();
  const double inputs = 0.05 * model.input_shapes.cwiseAbs().mean();
  for (auto& value : model.output_shapes.reshaped()) value += outputs * normal(dice);
  for (auto& value : model.input_shapes.reshaped()) value += inputs * normal(dice);
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    model.frequency_hz(m) *= 1.0 + 0.02 * std::clamp(normal(dice), -1.0, 1.0);
  }
  return model;
}

std::vector<std::pair<double, double>> frequencies(const ModeComparison& modes) {
  std::vector<std::pair<double, double>> all;
  for (const auto& pair : modes.pairs) all.emplace_back(pair.simulated_hz, pair.measured_hz);
  return all;
}

TEST(PairedModes, DoNotDependOnTheOrderOfModesOrChannels) {
  std::mt19937 dice(3);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto measured = nearly(truth(), seed);
    const auto expected = frequencies(compared(truth(), fit_of(measured)));
    EXPECT_GE(expected.size(), 15U);
    Indices modes(static_cast<std::size_t>(measured.mode_count()));
    for (std::size_t m = 0; m < modes.size(); ++m) modes[m] = static_cast<Eigen::Index>(m);
    std::shuffle(modes.begin() + measured.rigid_count, modes.end(), dice);
    EXPECT_EQ(frequencies(compared(truth(), fit_of(modes_of(measured, modes)))), expected);
    const Indices outputs = {2, 0, 3, 1};
    const Indices inputs = {12, 3, 0, 7, 1, 5, 2, 11, 4, 10, 6, 9, 8};
    const auto fit = fit_of(channels_of(measured, outputs, inputs));
    EXPECT_EQ(frequencies(compared(channels_of(truth(), outputs, inputs), fit)), expected);
  }
}

// Modes whose shapes are alike at these channels may change places; that is said.
TEST(PairedModes, AreTheSameModesWhereTheShapeDecides) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto modes = compared(truth(), fit_of(nearly(truth(), seed)));
    EXPECT_TRUE(modes.shapes_tell);
    EXPECT_EQ(modes.pairs.size(), 17U) << seed;
    int by_shape = 0;
    for (const auto& pair : modes.pairs) {
      // The modes of a repeated pair may be exchanged.
      const double within = pair.by_shape ? 0.006 : 0.05;
      const double f = truth().frequency_hz(pair.measured);
      EXPECT_NEAR(pair.simulated_hz, f, within * f) << seed;
      by_shape += pair.by_shape ? 1 : 0;
    }
    EXPECT_GE(by_shape, 8) << seed;
  }
}

// Few channels see shapes alike; frequencies do not make them one mode.
TEST(PairedModes, AreNeverFarApartInFrequency) {
  for (const auto& inputs : {Indices{0}, Indices{0, 5}, Indices{0, 1, 2, 3, 4, 5}}) {
    for (const auto& outputs : {Indices{0}, Indices{0, 1, 2}, Indices{0, 1, 2, 3}}) {
      const auto simulated = channels_of(truth(), outputs, inputs);
      for (unsigned seed = 1; seed <= 5; ++seed) {
        auto measured = nearly(simulated, seed);
        measured.frequency_hz *= 1.0 + 0.2 * static_cast<double>(seed);
        for (const auto& pair : compared(simulated, fit_of(measured)).pairs) {
          const double apart = std::abs(std::log(pair.measured_hz / pair.simulated_hz));
          EXPECT_LT(apart, 0.26) << pair.simulated_hz << " and " << pair.measured_hz;
        }
      }
    }
  }
}

TEST(PairedModes, OfAMeasurementThatIsFarOffHaveNoPartner) {
  const Indices lowest = {0, 1, 2, 3};  // one flexible mode
  const auto simulated = modes_of(truth(), lowest);
  auto measured = simulated;
  measured.frequency_hz *= 1.4;
  const auto modes = compared(simulated, fit_of(measured), {.low_hz = 20.0, .high_hz = 400.0});
  EXPECT_TRUE(modes.pairs.empty());
  ASSERT_EQ(modes.simulated_alone.size(), 1U);
  EXPECT_NEAR(modes.simulated_alone[0].frequency_hz, 139.0, 1e-9);
  ASSERT_EQ(modes.measured_alone.size(), 1U);
  EXPECT_NEAR(modes.measured_alone[0].frequency_hz, 1.4 * 139.0, 1e-9);
}

TEST(PairedModes, OfOneResponseGoByFrequencyAndSaySo) {
  const auto simulated = channels_of(truth(), {0}, {5});
  auto measured = simulated;
  measured.frequency_hz *= 1.02;
  const auto modes = compared(simulated, fit_of(measured));
  EXPECT_FALSE(modes.shapes_tell);
  EXPECT_NEAR(modes.confusion, 1.0, 1e-12);
  EXPECT_EQ(modes.pairs.size() + modes.simulated_unseen.size(), 17U);
  EXPECT_GE(modes.pairs.size(), 5U);
  for (const auto& pair : modes.pairs) {
    EXPECT_FALSE(pair.by_shape);
    EXPECT_NEAR(pair.change, 0.02, 1e-9) << pair.simulated_hz;
  }
}

TEST(PairedModes, SayWhereTheShapeAloneWouldNotTell) {
  // Two different modes, 8 % apart, that four sensors and one actuator see alike.
  auto simulated = modes_of(truth(), {0, 1, 2, 3, 4, 5});
  simulated.frequency_hz(4) = 1.08 * simulated.frequency_hz(3);
  simulated.output_shapes.col(4) = simulated.output_shapes.col(3);
  simulated.input_shapes.row(4) = simulated.input_shapes.row(3);
  auto measured = simulated;
  measured.frequency_hz *= 1.01;
  const auto modes = compared(simulated, fit_of(measured));
  ASSERT_EQ(modes.pairs.size(), 3U);
  EXPECT_FALSE(modes.pairs[0].by_shape);
  EXPECT_FALSE(modes.pairs[1].by_shape);
  EXPECT_TRUE(modes.pairs[2].by_shape);
  for (const auto& pair : modes.pairs) EXPECT_NEAR(pair.change, 0.01, 1e-9);
}

// --- What is a mode at all.

TEST(MeasuredModes, AreWithinTheBand) {
  const auto modes = compared(truth(), fit_of(truth()), {.low_hz = 150.0, .high_hz = 700.0});
  EXPECT_FALSE(modes.pairs.empty());
  EXPECT_FALSE(modes.no_modes.empty());
  for (const auto& pair : modes.pairs) {
    EXPECT_GE(pair.measured_hz, 150.0);
    EXPECT_LE(pair.measured_hz, 700.0);
  }
  for (const auto& pole : modes.no_modes) EXPECT_EQ(pole.why, "beside the band");
  for (const double f : modes.simulated_hz) EXPECT_LE(f, 700.0);
  EXPECT_EQ(modes.mac.rows(), static_cast<Eigen::Index>(modes.simulated_hz.size()));
  EXPECT_EQ(modes.mac.cols(), static_cast<Eigen::Index>(modes.measured_hz.size()));
}

TEST(MeasuredModes, AreThoseThatTheDataSupport) {
  const auto first = truth().rigid_count;
  auto fit = fit_of(truth());
  fit.model.damping_ratio(first) = 0.6;
  fit.frequency_std_hz(first + 1) = 0.5 * fit.model.frequency_hz(first + 1);
  fit.output_std.col(first + 2) = fit.model.output_shapes.col(first + 2).cwiseAbs();
  fit.frequency_std_hz(first + 5) = std::nan("");
  const auto modes = compared(truth(), fit);
  ASSERT_EQ(modes.no_modes.size(), 4U);
  EXPECT_NE(modes.no_modes[0].why.find("0.6: no resonance"), std::string::npos);
  EXPECT_NE(modes.no_modes[1].why.find("is known to"), std::string::npos);
  EXPECT_NE(modes.no_modes[2].why.find("three deviations"), std::string::npos);
  EXPECT_EQ(modes.no_modes[3].column, first + 5);
  EXPECT_EQ(modes.simulated_alone.size(), 4U);
  for (const auto& alone : modes.simulated_alone) {
    EXPECT_TRUE(std::ranges::any_of(modes.no_modes, [&](const ModeAlone& pole) {
      return std::abs(pole.frequency_hz / alone.frequency_hz - 1.0) < 0.006;
    })) << alone.frequency_hz;
  }
}

TEST(MeasuredModes, MayBeNoneAtAll) {
  auto fit = fit_of(truth());
  fit.model.damping_ratio.setConstant(0.9);
  const auto modes = compared(truth(), fit, {.low_hz = 20.0, .high_hz = 900.0});
  EXPECT_TRUE(modes.pairs.empty());
  EXPECT_FALSE(modes.simulated_alone.empty());
  EXPECT_TRUE(modes.measured_hz.empty());
  EXPECT_EQ(modes.mac.size(), 0);
}

TEST(SimulatedModes, ThatNoChannelSeesAreSaid) {
  auto simulated = truth();
  const auto gone = simulated.rigid_count + 2;
  simulated.input_shapes.row(gone).setZero();
  const auto modes = compared(simulated, fit_of(truth()));
  ASSERT_EQ(modes.simulated_unseen.size(), 1U);
  EXPECT_EQ(modes.simulated_unseen[0].column, gone);
}

// --- The assignment itself: against all that there are.

double best_saving(const Eigen::MatrixXd& cost, double alone, Eigen::Index row,
                   std::vector<bool>& taken) {
  if (row == cost.rows()) return 0.0;
  double best = best_saving(cost, alone, row + 1, taken);
  for (Eigen::Index j = 0; j < cost.cols(); ++j) {
    if (taken[static_cast<std::size_t>(j)]) continue;
    taken[static_cast<std::size_t>(j)] = true;
    best = std::max(best, alone - cost(row, j) + best_saving(cost, alone, row + 1, taken));
    taken[static_cast<std::size_t>(j)] = false;
  }
  return best;
}

TEST(Assigned, SavesTheMostThatIsPossible) {
  std::mt19937 dice(7);
  std::uniform_real_distribution<double> uniform;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd cost(1 + trial % 5, 1 + trial % 4);
    for (auto& value : cost.reshaped()) value = uniform(dice);
    const double alone = uniform(dice);
    std::vector<bool> taken(static_cast<std::size_t>(cost.cols()), false);
    double saved = 0.0;
    for (const auto& [i, j] : modal::assigned(cost, alone)) {
      EXPECT_LT(cost(i, j), alone);
      saved += alone - cost(i, j);
    }
    EXPECT_NEAR(saved, best_saving(cost, alone, 0, taken), 1e-12);
  }
}

TEST(Assigned, APairThatIsNotMadeKeepsNoOthersApart) {
  // 100 and 110 Hz against 110 and 160 Hz, by the square of how far apart they are.
  Eigen::Matrix2d cost;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      cost(i, j) = std::pow(std::log((j == 0 ? 110.0 : 160.0) / (i == 0 ? 100.0 : 110.0)), 2);
    }
  }
  const auto pairs = modal::assigned(cost, 0.05);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0], (std::pair<Eigen::Index, Eigen::Index>{1, 0}));
}

}  // namespace
}  // namespace chladni::diagnosis
