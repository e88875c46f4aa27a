#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/index.h"
#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulators::Dice;
using Complex = std::complex<double>;

double negative_log(const ModeErrors& errors) {
  return LevelLikelihood(errors, level_prior(Tolerances{}, true).usual).negative_log();
}

double likeness(const MeasuredModes& measured, const RecordedModes& model, Index i, Index k) {
  return partner(measured, model, some_units(), i, span_of(measured, model, i, k)).mac();
}

// Compares what does not depend on the sign in which a shape and its errors are written.
void expect_same(const MeasuredModes& measured, const RecordedModes& model,
                 const MeasuredModes& other_measured, const RecordedModes& other_model) {
  for (Index i = 0; i < measured.count(); ++i) {
    for (Index k = 0; k < model.count(); ++k) {
      EXPECT_NEAR(likeness(other_measured, other_model, i, k), likeness(measured, model, i, k),
                  1e-9)
          << i << " " << k;
    }
  }
  const auto matching = matched_by_shape(measured, model);
  EXPECT_EQ(matched_by_shape(other_measured, other_model).model, matching.model);
  const auto one = errors_of(measured, model, matching);
  const auto other = errors_of(other_measured, other_model, matching);
  const VectorXd difference = stacked(other).cwiseAbs() - stacked(one).cwiseAbs();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_NEAR(negative_log(other), negative_log(one), 1e-6);
}

TEST(Partner, HasTheLikenessOfItsMode) {
  const RecordedModes model = modes_of(loaded());
  const MeasuredModes exact = measured_of(model, 0.0);
  const MeasuredModes near = measured_of(model, 0.05);
  for (Index i = 0; i < exact.count(); ++i) {
    EXPECT_NEAR(likeness(exact, model, i, i), 1.0, 1e-9) << i;
    EXPECT_GT(likeness(near, model, i, i), 0.97) << i;
    EXPECT_LT(likeness(near, model, i, i), 1.0 - 1e-5) << i;
  }
}

TEST(Errors, AreZeroForTheModesOfTheModel) {
  const RecordedModes model = modes_of(loaded());
  MeasuredModes measured = measured_of(model, 0.0);
  measured.scaled = true;
  const auto errors = errors_of(measured, model, matched_by_shape(measured, model));
  EXPECT_LT(stacked(errors).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(errors.penalty, 0.0);
  EXPECT_EQ(stacked(errors).size(), kModes * (4 + 2 * (4 + 13)));
}

TEST(Errors, AreLogarithmsOfFrequencyAndDamping) {
  const RecordedModes model = modes_of(loaded());
  MeasuredModes measured = measured_of(model, 0.0);
  const auto matching = matched_by_shape(measured, model);
  measured.frequency_hz *= 1.03;
  measured.damping_ratio *= 0.5;
  for (const auto& block : errors_of(measured, model, matching).blocks) {
    EXPECT_NEAR(block.error(0), std::log(1.03), 1e-12);
    EXPECT_NEAR(block.error(1), std::log(0.5), 1e-12);
  }
}

TEST(Errors, DoNotDependOnTheFactorOfAMode) {
  const RecordedModes model = modes_of(loaded());
  const MeasuredModes measured = measured_of(model, 0.05);
  Dice dice(2);
  for (int round = 0; round < 4; ++round) {
    MeasuredModes other = measured;
    for (Index i = 0; i < measured.count(); ++i) {
      const auto put = [&](MatrixXcd& shapes, MatrixXd& deviation) {
        const Complex factor = std::polar(std::exp(3.0 * dice.normal()), 6.3 * dice.uniform());
        shapes.col(i) *= factor;
        deviation.col(i) *= std::abs(factor);
      };
      put(other.output_shapes, other.output_std);
      put(other.input_shapes, other.input_std);
    }
    expect_same(measured, model, other, model);
  }
}

TEST(Errors, DoNotDependOnTheSignOfAnEigenvector) {
  const RecordedModes model = modes_of(loaded());
  for (const bool scaled : {false, true}) {
    MeasuredModes measured = measured_of(model, 0.05);
    measured.scaled = scaled;
    RecordedModes other = model;
    for (const Index k : {0, 3, 4, 8, 11}) {
      for (auto* rows : {&other.outputs, &other.inputs, &other.motion}) rows->col(k) *= -1.0;
    }
    expect_same(measured, model, measured, other);
  }
}

// A model whose actuators all lie on the nodes of mode 2: its shape there is rounding, of any sign.
// Errors of the body give the measured one some shape.
RecordedModes blind(double sign) {
  RecordedModes model = modes_of(loaded());
  model.inputs.col(2) = sign * 1e-13 * Dice(6).normal(model.inputs.rows(), 1);
  return model;
}

MeasuredModes measured_beside_nodes() {
  auto measured = measured_of(blind(1.0), 0.05);
  measured.scaled = true;
  const Index q = measured.input_shapes.rows();
  measured.input_shapes.col(2) = 0.02 * Dice(7).normal(q, 1).cast<Complex>();
  return measured;
}

double phase_of_residue(const MeasuredModes& measured, const RecordedModes& model, Index i) {
  const auto other = partner(measured, model, some_units(), i, {i});
  return std::arg(other.sensors.factor * other.actuators.factor);
}

// The sensors and the residue tell which sign the actuators have: errors that sensors and actuators
// share lie on one side then.
TEST(Partner, OnItsNodesHasTheSignOfTheResidue) {
  auto measured = measured_beside_nodes();
  for (const bool turned : {false, true}) {
    if (turned) measured.input_shapes.col(2) *= -1.0;
    expect_same(measured, blind(1.0), measured, blind(-1.0));
    for (const double sign : {1.0, -1.0}) {
      EXPECT_NEAR(phase_of_residue(measured, blind(sign), 2), 0.0, 0.1) << turned << sign;
    }
  }
}

// Where channels see the mode a wrong sign stays one.
TEST(Partner, ThatIsSeenKeepsItsSign) {
  const RecordedModes model = modes_of(loaded());
  auto measured = measured_of(model, 0.05);
  measured.scaled = true;
  measured.input_shapes *= -1.0;
  for (Index i = 0; i < measured.count(); ++i) {
    EXPECT_NEAR(std::abs(phase_of_residue(measured, model, i)), std::numbers::pi, 0.3) << i;
  }
}

// Two modes of one frequency: any two of their plane are as good.
TEST(Errors, DoNotDependOnHowRepeatedModesAreTurned) {
  RecordedModes model = modes_of(loaded());
  model.frequency_hz(4) = model.frequency_hz(3);
  const MeasuredModes measured = measured_of(model, 0.05);
  Matching matching;
  for (Index i = 0; i < measured.count(); ++i) {
    matching.model.push_back(i);
    matching.span.push_back(span_of(measured, model, i, i));
  }
  const auto before = errors_of(measured, model, matching, false);
  for (const double angle : {0.3, 1.1, 2.9}) {
    RecordedModes other = model;
    for (auto* rows : {&other.outputs, &other.inputs, &other.motion}) {
      const VectorXd one = rows->col(3);
      const VectorXd two = rows->col(4);
      rows->col(3) = std::cos(angle) * one + std::sin(angle) * two;
      rows->col(4) = std::cos(angle) * two - std::sin(angle) * one;
    }
    for (const Index i : {3, 4}) {
      for (const Index k : {3, 4}) {
        EXPECT_NEAR(likeness(measured, other, i, k), likeness(measured, model, i, k), 1e-6);
        EXPECT_GT(likeness(measured, other, i, k), 0.97);
      }
    }
    const auto after = errors_of(measured, other, matching, false);
    for (const std::size_t i : {3, 4}) {
      const VectorXd difference =
          after.blocks[i].error.cwiseAbs() - before.blocks[i].error.cwiseAbs();
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6) << angle << " " << i;
    }
  }
}

TEST(Errors, LeaveOutWhatWasNotMeasured) {
  const RecordedModes model = modes_of(loaded());
  const MeasuredModes measured = measured_of(model, 0.05);
  const auto matching = matched_by_shape(measured, model);
  const double none = std::numeric_limits<double>::quiet_NaN();
  MeasuredModes less = measured;
  less.output_shapes(1, 2) = {none, none};
  less.input_shapes(5, 2) = {none, 0.0};
  less.damping_ratio(2) = none;
  const auto all = errors_of(measured, model, matching);
  const auto some = errors_of(less, model, matching);
  EXPECT_TRUE(stacked(some).allFinite());
  EXPECT_EQ(stacked(some).size(), stacked(all).size() - 5);
  for (std::size_t i = 0; i < all.blocks.size(); ++i) {
    if (i == 2) continue;
    EXPECT_EQ(some.blocks[i].error, all.blocks[i].error);
  }
  // What stands in its place is of no interest.
  MeasuredModes other = less;
  other.output_std(1, 2) = 7.0;
  EXPECT_EQ(stacked(errors_of(other, model, matching)), stacked(some));
  EXPECT_EQ(matched_by_shape(less, model).model, matching.model);
}

TEST(Errors, NeedNoShapes) {
  const RecordedModes model = modes_of(loaded());
  MeasuredModes measured = measured_of(model, 0.0);
  measured.output_shapes.setConstant({std::numeric_limits<double>::quiet_NaN(), 0.0});
  measured.input_shapes.setConstant({std::numeric_limits<double>::quiet_NaN(), 0.0});
  const auto matching = matched_by_shape(measured, model);
  for (std::size_t i = 0; i < matching.model.size(); ++i) {
    EXPECT_EQ(matching.model[i], static_cast<Index>(i));
  }
  EXPECT_EQ(stacked(errors_of(measured, model, matching)).size(), 2 * kModes);
}

TEST(Matched, FindsAListInAnyOrder) {
  const RecordedModes model = modes_of(loaded());
  const MeasuredModes sorted = measured_of(model, 0.05);
  std::vector<Index> order(at(sorted.count()));
  std::iota(order.begin(), order.end(), Index{0});
  Dice dice(3);
  for (int round = 0; round < 5; ++round) {
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1], order[at(dice.below(static_cast<Index>(i)))]);
    }
    MeasuredModes measured = sorted;
    measured.frequency_hz = sorted.frequency_hz(order);
    for (double& hz : measured.frequency_hz) hz *= std::exp(0.015 * dice.normal());
    measured.output_shapes = sorted.output_shapes(Eigen::all, order);
    measured.input_shapes = sorted.input_shapes(Eigen::all, order);
    const auto matching = matched_by_shape(measured, model);
    EXPECT_EQ(matching.model, order) << round;
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(matching.span[i].front(), order[i]);
  }
}

TEST(Matched, LeavesAStrangeModeAlone) {
  const RecordedModes model = modes_of(loaded());
  MeasuredModes measured = measured_of(model, 0.02);
  measured.frequency_hz(0) = 0.3 * model.frequency_hz(0);
  const auto matching = matched_by_shape(measured, model);
  EXPECT_EQ(matching.model[0], -1);
  EXPECT_TRUE(matching.span[0].empty());
  const auto errors = errors_of(measured, model, matching);
  EXPECT_TRUE(std::isfinite(negative_log(errors)));
  EXPECT_GT(errors.penalty, 0.0);
  // Its numbers are as many as those of a mode with a partner.
  EXPECT_EQ(errors.blocks[0].count(), errors.blocks[1].count());
}

// Evidences are compared of the same data: a dashpot brings none with it, nor takes any away.
TEST(Errors, AreAsManyForEveryHypothesis) {
  RecordedModes model = modes_of(loaded());
  const MeasuredModes measured = measured_of(model, 0.02);
  const auto matching = matched_by_shape(measured, model);
  const auto damped = errors_of(measured, model, matching);
  model.damping_ratio(1) = 0.0;
  const auto undamped = errors_of(measured, model, matching);
  EXPECT_EQ(stacked(undamped).size(), stacked(damped).size());

  Structure bare = small_plate();
  bare.damping_ratio.setZero();
  static const std::vector<BodyError> none;
  const MatrixXd smooth = smooth_factor(bare);
  auto alone = matching;
  alone.model[0] = -1;
  alone.span[0].clear();
  for (const auto& one : {matching, alone}) {
    for (const double ratio : {0.0, 1e-5, 0.02}) {
      RecordedModes other = model;
      other.damping_ratio.setConstant(ratio);
      const std::vector<bool> all(one.model.size(), true);
      const auto errors =
          mode_errors(bare, measured, other, some_units(), one, none, smooth, {}, all);
      EXPECT_EQ(errors.blocks[0].count(), damped.blocks[0].count() - 1) << ratio;
      EXPECT_EQ(errors.blocks[1].count(), damped.blocks[1].count() - 1) << ratio;
    }
  }
}

// A small change of a structure changes the errors a little, also where modes of one frequency part
// or frequencies cross.
TEST(Errors, AreContinuousInTheSizeOfACause) {
  const auto& plate = small_plate();
  MeasuredModes measured = measured_of(modes_of(state_of(plate)), 0.05);
  Dice dice(4);
  for (double& hz : measured.frequency_hz) hz *= std::exp(0.015 * dice.normal());
  std::sort(measured.frequency_hz.begin(), measured.frequency_hz.end());
  const ModesProblem problem(plate, measured, Tolerances{}, true);
  const auto at_place = [&](double size) {
    return VectorXd(Eigen::Vector3d(size * plate.mass_kg, 0.21, 0.13));
  };
  struct Case {
    std::string_view name;
    std::function<VectorXd(double)> x;
  };
  const std::vector<Case> cases{
      {"point_mass", at_place},
      {"actuator_masses",
       [&](double size) { return VectorXd::Constant(1, size * plate.mass_kg / 13.0); }},
      {"orthotropy", [](double size) { return VectorXd(Eigen::Vector2d(size, 0.0)); }},
      {"orthotropy", [](double size) { return VectorXd(Eigen::Vector2d(0.0, size)); }},
      {"thickness", [](double size) { return VectorXd::Constant(1, size); }},
  };
  const auto base = problem.modes(state_of(plate), false);
  ASSERT_TRUE(base);
  for (const auto& [name, x] : cases) {
    for (const auto& matching : problem.matchings(*base)) {
      const auto errors = [&](double size) {
        ModesFit fit;
        fit.causes.push_back({&effect(name), 0, x(size)});
        const auto model = problem.modes(problem.with(fit), false);
        return stacked(problem.errors({}, *model, matching, false));
      };
      for (const double size : {-0.02, -1e-3, -1e-5, 0.0, 1e-7, 1e-5, 1e-4, 1e-3, 5e-3, 0.02}) {
        const VectorXd here = errors(size);
        for (const double step : {-1e-4, -1e-6, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3}) {
          const VectorXd there = errors(size + step);
          ASSERT_EQ(there.size(), here.size());
          EXPECT_LT((there - here).cwiseAbs().maxCoeff(), 200.0 * std::abs(step) + 1e-7)
              << name << " of " << size << " and " << step << " more";
        }
      }
    }
  }
}

// The errors of ln residue, real parts.
VectorXd residue_errors(const MeasuredModes& measured, const RecordedModes& model) {
  const auto errors = errors_of(measured, model, matched_by_shape(measured, model));
  VectorXd all(measured.count());
  for (Index i = 0; i < all.size(); ++i) {
    const auto& block = errors.blocks[at(i)];
    const auto own = std::ranges::find(block.of, static_cast<int>(ErrorClass::residue));
    EXPECT_NE(own, block.of.end()) << i;
    all(i) = block.error(own - block.of.begin());
  }
  return all;
}

// Two modes that damping couples turn by a complex angle: of v = cosh b u + i sinh b w the residue
// is larger by cosh 2b. The body is no lighter for that.
TEST(Errors, OfComplexModesHaveNoLargerResidues) {
  const auto model = modes_of(loaded());
  auto real = measured_of(model, 0.0);
  real.scaled = true;
  EXPECT_LT(residue_errors(real, model).cwiseAbs().maxCoeff(), 1e-9);
  for (const double b : {0.1, 0.3, 0.5}) {
    auto measured = real;
    for (auto* shapes : {&measured.output_shapes, &measured.input_shapes}) {
      const MatrixXcd pair = shapes->middleCols(3, 2);
      shapes->col(3) = std::cosh(b) * pair.col(0) + Complex(0.0, std::sinh(b)) * pair.col(1);
      shapes->col(4) = std::cosh(b) * pair.col(1) - Complex(0.0, std::sinh(b)) * pair.col(0);
    }
    const double larger = std::log(std::cosh(2.0 * b));
    const VectorXd errors = residue_errors(measured, model);
    EXPECT_LT(std::abs(errors(3) + errors(4)), 0.4 * larger) << b << ": " << errors.transpose();
  }
}

}  // namespace
}  // namespace chladni::diagnosis
