// Complex modes: fitted, their deviations, and what may not depend on units and phases.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/draw.h"
#include "fit_errors.h"
#include "general_case.h"
#include "identification/modal_fit.h"
#include "modal/state_space.h"
#include "rotation/turn.h"
#include "simulators/frf_cases.h"

namespace chladni::identification {
namespace {

using simulators::FrfFaults;
using Complex = std::complex<double>;

const FitOptions kGeneral{.damping = Damping::general};

simulators::FrfCase with_dashpot(double constant, unsigned seed = 1, bool noisy = true) {
  FrfFaults faults;
  faults.dashpot = constant;
  faults.seed = seed;
  faults.noisy = noisy;
  return simulators::beam5x3(faults);
}

// The true poles, moved by a tenth of a bandwidth and their damping by a tenth.
Start near(const Eigen::VectorXcd& poles, unsigned seed) {
  Draw draw(seed);
  Start start;
  start.pole = poles;
  for (auto& pole : start.pole) {
    const double half = -pole.real();
    pole = {-half * std::exp(0.1 * draw.normal()), pole.imag() + 0.2 * half * draw.normal()};
  }
  return start;
}

Eigen::VectorXcd poles_of(const ModalFit& fit) {
  const Eigen::ArrayXd own = 2.0 * std::numbers::pi * fit.model.frequency_hz.array();
  const Eigen::ArrayXd ratio = fit.model.damping_ratio.array();
  Eigen::VectorXcd poles(own.size());
  poles.real() = -ratio * own;
  poles.imag() = own * (1.0 - ratio.square()).sqrt();
  return poles;
}

// Shapes of a fit with the sign that is nearer to the truth's: the largest entry may be either of
// two.
ComplexShapes signed_as(const GeneralTruth& truth, const ModalFit& fit) {
  ComplexShapes shapes = *fit.complex;
  for (Eigen::Index m = 0; m < truth.pole.size(); ++m) {
    if (truth.outputs.col(m).dot(shapes.outputs.col(m)).real() > 0.0) continue;
    shapes.outputs.col(m) *= -1.0;
    shapes.inputs.row(m) *= -1.0;
  }
  return shapes;
}

TEST(GeneralDamping, IsExactWithoutNoiseInAnyUnits) {
  const auto made = with_dashpot(1.0, 1, false);
  const auto truth = general_truth(made);
  const auto exact = fit_data(made.measured);
  for (const double hertz : {1e-3, 1.0, 1e6}) {
    for (const double metre : {1.0, 1e6}) {
      FitData data = exact;
      data.frequency_hz *= hertz;
      data.value *= metre / (hertz * hertz);
      data.weight /= metre / (hertz * hertz);
      auto start = near(truth.pole, 3);
      start.pole *= hertz;
      const auto fit = modal_fit(data, start, kGeneral);
      ASSERT_EQ(fit.damping(), Damping::general);
      const Eigen::VectorXcd poles = poles_of(fit) / hertz;
      const auto shapes = signed_as(truth, fit);
      for (Eigen::Index m = 0; m < 5; ++m) {
        EXPECT_LT(std::abs(poles(m) / truth.pole(m) - 1.0), 1e-11) << hertz << ' ' << metre;
        const double root = std::sqrt(metre);
        EXPECT_LT((shapes.outputs.col(m) / root - truth.outputs.col(m)).norm(),
                  1e-7 * truth.outputs.col(m).norm());
        EXPECT_LT((shapes.inputs.row(m) / root - truth.inputs.row(m)).norm(),
                  1e-7 * truth.inputs.row(m).norm());
      }
      EXPECT_LT((responses(fit, data.frequency_hz) - data.value).cwiseProduct(data.weight).norm(),
                1e-10 * data.value.cwiseProduct(data.weight).norm());
    }
  }
}

// T15: to the bound, where real modes are rejected.
TEST(GeneralDamping, ReachesTheBoundWhereRealModesAreRejected) {
  EVERY_FOURTH_LANDING();
  const auto first = with_dashpot(1.0);
  const auto truth = general_truth(first);
  const auto bounds = general_bounds(first, truth);
  EXPECT_GT(excess(modal_fit(fit_data(first.measured), near(truth.pole, 1))), 50.0);
  constexpr int kSeeds = 60;
  Eigen::ArrayXd frequency = Eigen::ArrayXd::Zero(5);
  Eigen::ArrayXd damping = frequency;
  Eigen::ArrayXd shape = frequency;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto made = with_dashpot(1.0, seed);
    const auto fit = modal_fit(fit_data(made.measured), near(truth.pole, seed), kGeneral);
    ASSERT_EQ(fit.model.mode_count(), 5);
    EXPECT_LT(std::abs(excess(fit)), 4.0) << seed;
    for (Eigen::Index m = 0; m < 5; ++m) {
      const double own = std::abs(truth.pole(m)) / (2.0 * std::numbers::pi);
      const double ratio = -truth.pole(m).real() / std::abs(truth.pole(m));
      frequency(m) += std::pow((fit.model.frequency_hz(m) - own) / bounds.frequency_hz(m), 2);
      damping(m) += std::pow((fit.model.damping_ratio(m) - ratio) / bounds.damping(m), 2);
      const Eigen::MatrixXcd off = fit.complex->outputs.col(m) * fit.complex->inputs.row(m) -
                                   truth.outputs.col(m) * truth.inputs.row(m);
      shape(m) += std::pow(off.norm() / bounds.shape(m), 2);
    }
    if (seed > 1) continue;
    EXPECT_LT((fit.frequency_std_hz.array() / bounds.frequency_hz.array() - 1.0).abs().maxCoeff(),
              0.03);
    EXPECT_LT((fit.damping_std.array() / bounds.damping.array() - 1.0).abs().maxCoeff(), 0.03);
  }
  // Three deviations of a mean square of 60; the shape's has more freedoms.
  for (const auto& square : {frequency, damping, shape}) {
    const Eigen::ArrayXd root = (square / kSeeds).sqrt();
    EXPECT_GT(root.minCoeff(), 0.72) << root.transpose();
    EXPECT_LT(root.maxCoeff(), 1.28) << root.transpose();
  }
}

// Every entry is compared: the phase between both sides is part of it.
TEST(GeneralDamping, StatesTheDeviationsOfItsShapes) {
  EVERY_FOURTH_LANDING();
  const auto truth = general_truth(with_dashpot(1.0));
  Eigen::ArrayXd square = Eigen::ArrayXd::Zero(4);
  constexpr int kSeeds = 150;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto made = with_dashpot(1.0, seed);
    const auto fit = modal_fit(fit_data(made.measured), near(truth.pole, seed), kGeneral);
    const auto shapes = signed_as(truth, fit);
    const Eigen::MatrixXcd outputs = shapes.outputs - truth.outputs;
    const Eigen::MatrixXcd inputs = shapes.inputs - truth.inputs;
    square(0) += outputs.real().cwiseQuotient(shapes.output_real_std).squaredNorm() / 25;
    square(1) += outputs.imag().cwiseQuotient(shapes.output_imaginary_std).squaredNorm() / 25;
    square(2) += inputs.real().cwiseQuotient(shapes.input_real_std).squaredNorm() / 15;
    square(3) += inputs.imag().cwiseQuotient(shapes.input_imaginary_std).squaredNorm() / 15;
    EXPECT_EQ(fit.model.output_shapes, fit.complex->outputs.real());
    EXPECT_EQ(fit.output_std, shapes.output_real_std);
    EXPECT_EQ(fit.mode_covariance[2], shapes.covariance[2].topLeftCorner(10, 10));
  }
  EXPECT_GT(square.minCoeff() / kSeeds, 0.85) << square.transpose() / kSeeds;
  EXPECT_LT(square.maxCoeff() / kSeeds, 1.15) << square.transpose() / kSeeds;
}

TEST(GeneralDamping, IsThatOfRealModesWhereTheDampingIsModal) {
  for (const auto& made : {simulators::beam5x3(), simulators::big(5, 4, 9, 800)}) {
    const auto data = fit_data(made.measured);
    const auto real = modal_fit(data, start_at(made.truth));
    const auto general = modal_fit(data, start_at(made.truth), kGeneral);
    const auto r = made.truth.rigid_count;
    const auto n = made.truth.mode_count() - r;
    ASSERT_EQ(general.model.mode_count(), n + r);
    const auto channels = data.outputs + data.inputs;
    EXPECT_EQ(general.parameter_count - real.parameter_count, n * (channels - 1));
    EXPECT_LT(std::abs(excess(general)), 4.0);
    // What more freedom wins is what noise gives it.
    const double won = 2.0 * (real.cost - general.cost);
    const auto more = static_cast<double>(n * (channels - 1));
    EXPECT_NEAR(won, more, 4.0 * std::sqrt(2.0 * more));
    const auto within = [](const Eigen::ArrayXXd& difference, const Eigen::ArrayXXd& deviation) {
      return (difference / deviation).abs().maxCoeff();
    };
    EXPECT_LT(within(general.model.frequency_hz.tail(n) - real.model.frequency_hz.tail(n),
                     general.frequency_std_hz.tail(n)),
              4.0);
    EXPECT_LT(within(general.model.damping_ratio.tail(n) - real.model.damping_ratio.tail(n),
                     general.damping_std.tail(n)),
              4.0);
    for (auto m = r; m < n + r; ++m) {
      const auto& one = real.model.output_shapes.col(m);
      const double sign = one.dot(general.model.output_shapes.col(m)) < 0.0 ? -1.0 : 1.0;
      EXPECT_LT(within(general.model.output_shapes.col(m) - sign * one, general.output_std.col(m)),
                4.0)
          << m;
    }
    EXPECT_LT(within(general.complex->outputs.imag().rightCols(n),
                     general.complex->output_imaginary_std.rightCols(n)),
              4.5);
    for (Eigen::Index m = r; m < n + r; ++m) {
      EXPECT_GT(phase_collinearity(general.complex->outputs.col(m)), 0.99) << m;
    }
  }
}

// Two modes of nearly one frequency that a dashpot couples: blocks lead to them.
TEST(GeneralDamping, TellsCoupledPairsApart) {
  for (const double split : {1e-2, 1e-3}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      FrfFaults faults;
      faults.seed = seed;
      faults.dashpot = 0.5;
      const auto made = simulators::pairs(split, 0.01, 0.012, faults);
      const auto truth = general_truth(made);
      const auto fit = modal_fit(fit_data(made.measured), near(truth.pole, seed), kGeneral);
      ASSERT_EQ(fit.model.mode_count(), 4);
      EXPECT_LT(std::abs(excess(fit)), 4.0) << split << " seed " << seed;
      EXPECT_LT(largest_sine(truth.outputs.middleCols(1, 2).real(),
                             fit.complex->outputs.middleCols(1, 2).real()),
                0.05);
    }
  }
}

// A delay turns the phases of the modes as complex shapes do: it is known by what is between them
// alone, which is little.
TEST(GeneralDamping, HardlyKnowsADelay) {
  FrfFaults faults;
  faults.delay_s = 2.0 / 4096.0;
  faults.dashpot = 1.0;
  const auto made = simulators::beam5x3(faults);
  FitOptions options = kGeneral;
  options.delay = true;
  const auto fit = modal_fit(fit_data(made.measured), near(general_truth(made).pole, 1), options);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_NEAR(fit.delay_s, faults.delay_s, 4.0 * fit.delay_std_s);
  EXPECT_GT(fit.delay_std_s, 0.2 * faults.delay_s);
}

TEST(GeneralDamping, IsTheSameAsAStateSpace) {
  for (const auto& made : {with_dashpot(1.0), simulators::big(4, 3, 7, 600)}) {
    const auto start =
        made.truth.rigid_count > 0 ? start_at(made.truth) : near(general_truth(made).pole, 1);
    const auto fit = modal_fit(fit_data(made.measured), start, kGeneral);
    const auto space = state_space(fit.model, *fit.complex);
    for (const double f : {3.0, 31.0, 77.7, 150.0}) {
      const Eigen::MatrixXcd there = modal::response(space, f);
      const Eigen::MatrixXcd fitted = responses(fit, Eigen::VectorXd::Constant(1, f));
      EXPECT_LT((there.reshaped().transpose() - fitted).norm(), 1e-12 * fitted.norm()) << f;
    }
  }
}

TEST(GeneralDamping, HoldsWithAChannelThatIsNotMeasured) {
  auto made = with_dashpot(1.0);
  const auto truth = general_truth(made);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& line : made.measured.value) line.row(3).setConstant({nan, nan});
  const auto fit = modal_fit(fit_data(made.measured), near(truth.pole, 1), kGeneral);
  EXPECT_LT(std::abs(excess(fit)), 4.0);
  EXPECT_TRUE(fit.complex->outputs.allFinite());
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_EQ(fit.complex->output_real_std.row(i).allFinite(), i != 3);
    EXPECT_EQ(fit.complex->output_imaginary_std.row(i).allFinite(), i != 3);
  }
  EXPECT_TRUE(fit.complex->input_imaginary_std.allFinite());
}

TEST(GeneralDamping, KnowsHowCollinearPhasesAre) {
  const Eigen::VectorXd real{{1.0, -2.0, 0.5}};
  EXPECT_NEAR(phase_collinearity(real * std::polar(1.0, 0.7)), 1.0, 1e-15);
  const Eigen::VectorXcd circle{{{1.0, 0.0},
                                 std::polar(1.0, 2.0 * std::numbers::pi / 3.0),
                                 std::polar(1.0, 4.0 * std::numbers::pi / 3.0)}};
  EXPECT_NEAR(phase_collinearity(circle), 0.0, 1e-15);
  EXPECT_EQ(phase_collinearity(Eigen::VectorXcd::Zero(3)), 1.0);
  const Eigen::VectorXcd shape{{{1.0, 0.3}, {-0.2, 0.9}}};
  EXPECT_NEAR(phase_collinearity(shape * Complex(-3.0, 8.0)), phase_collinearity(shape), 1e-15);
}

}  // namespace
}  // namespace chladni::identification
