#include "identification/likelihood/equal_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "block_problem.h"

namespace chladni::identification {
namespace {

// The weights of the first response for all.
Problem common_problem(unsigned seed) {
  auto result = problem(seed);
  result.target.squared = result.target.squared.col(0).replicate(1, 6).eval();
  result.target.squared.row(11).setZero();
  return result;
}

// Largest difference of an entry over the root of its diagonal entries.
double difference(const NormalEquations& a, const NormalEquations& b) {
  const Eigen::MatrixXd one = a.matrix.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd two = b.matrix.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd unit = two.diagonal().cwiseSqrt().cwiseInverse();
  return (unit.asDiagonal() * (one - two) * unit.asDiagonal()).cwiseAbs().maxCoeff();
}

void expect_the_same(Problem from, const Fitted& fitted, const std::string& what) {
  const auto now = misfit(from.model, from.target, fitted);
  const auto want = normal_equations_by_response(from.model, now, from.target, fitted);
  const auto found = normal_equations_of_equal_weights(from.model, now, from.target, fitted);
  ASSERT_EQ(found.matrix.rows(), want.matrix.rows());
  EXPECT_LT(difference(found, want), 1e-12) << what;
  EXPECT_LT((found.gradient - want.gradient).norm(), 1e-12 * want.gradient.norm()) << what;
}

TEST(EqualWeights, GiveTheNormalEquationsOfEachSortOfBlock) {
  const std::vector<std::string> name = {"single", "pair", "triple", "rigid", "complex"};
  for (std::size_t b = 0; b < name.size(); ++b) {
    auto from = common_problem(3);
    from.model.blocks = {from.model.blocks[b]};
    expect_the_same(from, {.residual = false, .delay = false}, name[b]);
    expect_the_same(from, {.residual = true, .delay = true}, name[b]);
  }
}

TEST(EqualWeights, GiveTheNormalEquationsOfAllBlocksTogether) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    for (const bool residual : {false, true}) {
      for (const bool delay : {false, true}) {
        expect_the_same(common_problem(seed), {.residual = residual, .delay = delay},
                        residual ? "with residual" : "without residual");
      }
    }
  }
}

TEST(EqualWeights, KnowTheDelayOfEachChannel) {
  for (const auto of : {DelayOf::outputs, DelayOf::inputs}) {
    auto from = common_problem(2);
    from.model.channel_delay =
        Eigen::VectorXd::LinSpaced(of == DelayOf::outputs ? 3 : 2, -0.4, 0.7);
    expect_the_same(from, {.residual = true, .delay = true, .delay_of = of}, "of each channel");
  }
}

// Two poles of one block that are one: no difference of them is divided by.
TEST(EqualWeights, HoldForABlockOfEqualPoles) {
  auto from = common_problem(6);
  auto pair = from.model.blocks[1];
  pair.stiffness = 0.25 * Eigen::Matrix2d::Identity();
  pair.damping = 0.05 * Eigen::Matrix2d::Identity();
  from.model.blocks = {pair};
  const Fitted fitted{.residual = true, .delay = false};
  const auto now = misfit(from.model, from.target, fitted);
  const auto found = normal_equations_of_equal_weights(from.model, now, from.target, fitted);
  // As two single modes the same shapes have the same derivatives; parameters: 6 left and 4 right
  // of the pair, 3, 2, 1 and 1 of each mode.
  auto apart = from;
  const auto mode = [&](Eigen::Index a) {
    return Block{.left = pair.left.col(a),
                 .right = pair.right.row(a),
                 .stiffness = Eigen::MatrixXd::Constant(1, 1, 0.25),
                 .damping = Eigen::MatrixXd::Constant(1, 1, 0.05)};
  };
  apart.model.blocks = {mode(0), mode(1)};
  const auto there = misfit(apart.model, apart.target, fitted);
  const auto want = normal_equations_by_response(apart.model, there, apart.target, fitted);
  const std::vector<Eigen::Index> of_pair = {0, 1, 2, 6, 8, 10, 14, 3, 4, 5, 7, 9, 13, 17};
  const Eigen::MatrixXd full = found.matrix.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd all = want.matrix.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd unit = all.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((unit.asDiagonal() * (full(of_pair, of_pair) - all) * unit.asDiagonal())
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
}

TEST(EqualWeights, AreLookedForInEveryResponse) {
  auto from = common_problem(4);
  from.model.blocks = {from.model.blocks[0]};
  EXPECT_TRUE(equal_weights_pay(from.model, from.target));
  from.target.squared(5, 4) *= 1.0 + 1e-12;
  EXPECT_FALSE(equal_weights_pay(from.model, from.target));
  from.target.squared.col(4).setZero();  // not measured
  EXPECT_FALSE(equal_weights_pay(from.model, from.target));
}

}  // namespace
}  // namespace chladni::identification
