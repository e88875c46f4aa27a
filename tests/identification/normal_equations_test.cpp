#include "identification/likelihood/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "block_problem.h"
#include "identification/likelihood/block_fractions.h"
#include "identification/likelihood/levenberg.h"

namespace chladni::identification {
namespace {

constexpr Fitted kAll{.residual = true, .delay = true};
constexpr Fitted kOutputs{.residual = true, .delay = true, .delay_of = DelayOf::outputs};

// All weighted errors as one column, the parameters moved by a step.
Eigen::VectorXd errors(const Problem& from, const Eigen::VectorXd& step,
                       const Fitted& fitted = kAll) {
  BlockModel model = from.model;
  Eigen::Index at = 0;
  for (auto& block : model.blocks) {
    const auto take = [&](Eigen::MatrixXd& part) {
      part += step.segment(at, part.size()).reshaped(part.rows(), part.cols());
      at += part.size();
    };
    take(block.left);
    take(block.right);
    if (block.general) {
      block.pole += std::complex<double>(step(at), step(at + 1));
      at += 2;
    }
    if (block.rigid || block.general) continue;
    take(block.stiffness);
    take(block.damping);
  }
  if (fitted.delay_of == DelayOf::all) {
    model.delay += step(at);
  } else {
    model.channel_delay += step.tail(step.size() - at);
  }
  const auto result = misfit(model, from.target, fitted);
  const Eigen::MatrixXd root = from.target.squared.cwiseSqrt();
  Eigen::MatrixXd weighted = result.error;
  weighted.topRows(60).array() *= root.array();
  weighted.bottomRows(60).array() *= root.array();
  return weighted.reshaped();
}

TEST(NormalEquations, AreThoseOfDifferences) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Problem from = problem(seed);
    const auto now = misfit(from.model, from.target, kAll);
    const auto normal = normal_equations(from.model, now, from.target, kAll);
    const auto n = parameter_count(from.model, kAll);
    ASSERT_EQ(normal.gradient.size(), n);
    Eigen::MatrixXd jacobian(now.error.size(), n);
    constexpr double kStep = 3e-5;
    for (Eigen::Index c = 0; c < n; ++c) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(n, c);
      jacobian.col(c) = (8.0 * (errors(from, step) - errors(from, -step)) -
                         errors(from, 2.0 * step) + errors(from, -2.0 * step)) /
                        (12.0 * kStep);
    }
    const Eigen::VectorXd gradient = -jacobian.transpose() * errors(from, Eigen::VectorXd::Zero(n));
    EXPECT_LT((normal.gradient - gradient).norm(), 1e-6 * gradient.norm());
    // The error turns with the data when the delay moves; its row is that of the model's delay.
    const Eigen::MatrixXd matrix = normal.matrix.selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd square = jacobian.transpose() * jacobian;
    EXPECT_LT((matrix - square).topLeftCorner(n - 1, n - 1).norm(),
              1e-6 * square.topLeftCorner(n - 1, n - 1).norm());
  }
}

// The gradient is that of the cost: each delay moves the data of its own channel only.
TEST(NormalEquations, KnowTheDelayOfEachOutput) {
  Problem from = problem(2);
  from.model.channel_delay = Eigen::Vector3d(0.2, -0.1, 0.5);
  const auto now = misfit(from.model, from.target, kOutputs);
  const auto normal = normal_equations(from.model, now, from.target, kOutputs);
  const auto n = parameter_count(from.model, kOutputs);
  ASSERT_EQ(n, parameter_count(from.model, kAll) + 2);
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(n, n - 3 + i);
    const double slope =
        (errors(from, step, kOutputs).squaredNorm() - errors(from, -step, kOutputs).squaredNorm()) /
        (2.0 * kStep);
    EXPECT_NEAR(-2.0 * normal.gradient(n - 3 + i), slope, 1e-5 * std::abs(slope)) << i;
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_EQ(normal.matrix(n - 3 + i, n - 3 + j), 0.0);
  }
}

// A mode above the band with hardly any damping: its poles are nearer to their mirror images than
// to any line by many orders.
TEST(NormalEquations, HoldForAModeOutsideTheBandWithoutDamping) {
  Problem from = problem(5);
  auto& block = from.model.blocks[0];
  block.stiffness(0, 0) = 1.4 * 1.4;
  block.damping(0, 0) = 1e-9;
  const auto now = misfit(from.model, from.target, kAll);
  const auto normal = normal_equations(from.model, now, from.target, kAll);
  const auto n = parameter_count(from.model, kAll);
  const Eigen::Index own = 3 + 2 + 2;  // left, right, stiffness, damping of the single mode
  Eigen::MatrixXd jacobian(now.error.size(), own);
  constexpr double kStep = 3e-5;
  for (Eigen::Index c = 0; c < own; ++c) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(n, c);
    jacobian.col(c) = (8.0 * (errors(from, step) - errors(from, -step)) - errors(from, 2.0 * step) +
                       errors(from, -2.0 * step)) /
                      (12.0 * kStep);
  }
  const Eigen::MatrixXd matrix =
      normal.matrix.topLeftCorner(own, own).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd square = jacobian.transpose() * jacobian;
  for (Eigen::Index a = 0; a < own; ++a) {
    for (Eigen::Index b = 0; b < own; ++b) {
      EXPECT_NEAR(matrix(a, b), square(a, b), 1e-5 * std::sqrt(square(a, a) * square(b, b)))
          << a << ' ' << b;
    }
  }
}

// l r / (s − p) and its conjugate.
TEST(NormalEquations, KnowAComplexMode) {
  const Eigen::VectorXcd l{{{1.0, 0.3}, {-0.4, 0.8}, {0.2, 0.0}}};
  const Eigen::RowVectorXcd r{{{0.5, -0.2}, {0.1, 0.7}}};
  const std::complex<double> pole(-0.02, 0.5);
  Problem from = problem(1);
  from.model.blocks = {general_mode(pole, l, r)};
  from.model.delay = 0.0;
  from.target.value.setZero();
  const auto all = misfit(from.model, from.target, {.residual = false, .delay = false});
  for (Eigen::Index k = 0; k < 60; ++k) {
    const std::complex<double> s(0.0, from.target.x(k));
    const Eigen::MatrixXcd response =
        l * r / (s - pole) + (l * r).conjugate() / (s - std::conj(pole));
    const Eigen::RowVectorXcd row = response.reshaped().transpose();
    EXPECT_LT((all.error.row(k) + row.real()).norm(), 1e-13 * row.norm());
    EXPECT_LT((all.error.row(60 + k) + row.imag()).norm(), 1e-13 * row.norm());
  }
}

// A pair that its damping couples is two complex modes, and the same responses.
TEST(NormalEquations, KnowACoupledBlockAsComplexModes) {
  Problem from = problem(4);
  const double before = misfit(from.model, from.target, kAll).cost;
  auto& blocks = from.model.blocks;
  const auto count = blocks.size();
  for (std::size_t b = 0; b < 3; ++b) {
    for (const auto& mode : general_modes(blocks[b])) blocks.push_back(mode);
  }
  ASSERT_EQ(blocks.size(), count + 6);
  blocks.erase(blocks.begin(), blocks.begin() + 3);
  EXPECT_NEAR(misfit(from.model, from.target, kAll).cost / before, 1.0, 1e-11);
}

TEST(NormalEquations, DoNotDependOnTheBasisOfABlock) {
  Problem from = problem(4);
  const double before = misfit(from.model, from.target, kAll).cost;
  for (auto& block : from.model.blocks) block = balanced(block);
  const double after = misfit(from.model, from.target, kAll).cost;
  EXPECT_NEAR(after / before, 1.0, 1e-12);
}

// A step that is damped much brings little, wherever it is: one alone is no end.
TEST(LevenbergDescent, GoesOnAfterOneDampedStepThatBringsLittle) {
  constexpr Fitted kFitted{.residual = true};
  auto made = problem(1);
  made.model.delay = 0.0;
  made.target.value.setZero();
  made.target.value = -misfit(made.model, made.target, kFitted).error;
  ASSERT_LT(misfit(made.model, made.target, kFitted).cost, 1e-20);
  made.target.total = made.target.value.squaredNorm();
  made.target.expected_cost = 360.0;  // one for each number
  BlockModel start = made.model;
  start.blocks.front().left *= 1.1;
  const double before = misfit(start, made.target, kFitted).cost;
  for (const double damping : {1e-4, 4e6}) {
    const auto found = descent(start, made.target, kFitted, {.damping = damping});
    EXPECT_LT(found.misfit.cost, 1e-6 * before) << damping;
    EXPECT_GT(found.iterations, 2);
  }
}

}  // namespace
}  // namespace chladni::identification
