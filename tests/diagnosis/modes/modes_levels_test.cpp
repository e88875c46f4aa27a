#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "base/index.h"
#include "diagnosis/modes/errors/levels.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulators::Dice;

constexpr int kFrequency = static_cast<int>(ErrorClass::frequency);
constexpr int kShape = static_cast<int>(ErrorClass::shape);
constexpr int kGain = static_cast<int>(ErrorClass::gain);

PerClass some_levels() {
  PerClass levels;
  levels << 0.02, 0.3, 0.07, 0.05, 0.11, 0.04, 0.003, 0.02;
  return levels;
}

// Blocks of 5, 1 and 7 numbers of all classes and of none, with errors that they share.
ModeErrors some_errors(Dice& dice, Index mixed) {
  ModeErrors errors;
  errors.shared_of = {kGain, -1, static_cast<int>(ErrorClass::field),
                      static_cast<int>(ErrorClass::place), kGain};
  errors.penalty = 1.7;
  for (const Index n : {5, 1, 7}) {
    ModeBlock block;
    block.error = 0.1 * dice.normal(n, 1);
    block.noise = (0.01 + 0.02 * dice.normal(n, 1).cwiseAbs().array()).matrix();
    for (Index i = 0; i < n; ++i) {
      block.of.push_back(static_cast<int>(i) % 6 - 1);
      block.weight.push_back(dice.between(0.5, 2.0));
    }
    block.free = 0.2 * dice.normal(n, 2);
    block.mixed = 2.0 * dice.normal(n, mixed);
    block.shared = dice.normal(n, 5);
    errors.blocks.push_back(std::move(block));
  }
  return errors;
}

// The errors of a class as columns of all numbers, times their level. One that is no class (−1)
// has the errors of unit deviation. Those of the frequencies may be with or without what modes
// nearby add.
MatrixXd columns_of(const ModeErrors& errors, const PerClass& levels, int of, bool mixed = true) {
  const Index n = stacked(errors).size();
  const double level = of < 0 ? 1.0 : levels(of);
  std::vector<VectorXd> all;
  Index first = 0;
  for (const auto& block : errors.blocks) {
    for (Index i = 0; i < block.count(); ++i) {
      if (of >= 0 && block.of[at(i)] == of) {
        all.emplace_back(level * block.weight[at(i)] * VectorXd::Unit(n, first + i));
      }
    }
    const MatrixXd& own = of < 0 ? block.free : block.mixed;
    for (Index c = 0; (of < 0 || (of == kFrequency && mixed)) && c < own.cols(); ++c) {
      all.emplace_back(VectorXd::Zero(n));
      all.back().segment(first, block.count()) = level * own.col(c);
    }
    first += block.count();
  }
  for (std::size_t c = 0; c < errors.shared_of.size(); ++c) {
    if (errors.shared_of[c] != of) continue;
    VectorXd column(n);
    first = 0;
    for (const auto& block : errors.blocks) {
      column.segment(first, block.count()) = level * block.shared.col(static_cast<Index>(c));
      first += block.count();
    }
    all.push_back(std::move(column));
  }
  MatrixXd columns(n, static_cast<Index>(all.size()));
  for (std::size_t c = 0; c < all.size(); ++c) columns.col(static_cast<Index>(c)) = all[c];
  return columns;
}

MatrixXd dense_covariance(const ModeErrors& errors, const PerClass& levels) {
  const Index n = stacked(errors).size();
  MatrixXd all = MatrixXd::Zero(n, n);
  Index first = 0;
  for (const auto& block : errors.blocks) {
    all.diagonal().segment(first, block.count()) = block.noise.cwiseAbs2();
    first += block.count();
  }
  for (int of = -1; of < static_cast<int>(kErrorClasses); ++of) {
    const MatrixXd columns = columns_of(errors, levels, of);
    all += columns * columns.transpose();
  }
  return all;
}

double dense_negative_log(const MatrixXd& covariance, const VectorXd& error) {
  const Eigen::LLT<MatrixXd> factor(covariance);
  const MatrixXd lower = factor.matrixL();
  return 0.5 * error.dot(factor.solve(error)) + lower.diagonal().array().log().sum() +
         0.5 * static_cast<double>(error.size()) * std::log(2.0 * std::numbers::pi);
}

// Numbers of one class without noise, each in a block of its own.
ModeErrors plain(const VectorXd& error, int of) {
  ModeErrors errors;
  for (const double one : error) {
    ModeBlock block;
    block.error = VectorXd::Constant(1, one);
    block.noise = VectorXd::Zero(1);
    block.of = {of};
    block.weight = {1.0};
    for (auto* columns : {&block.free, &block.mixed, &block.smooth, &block.shared}) {
      columns->resize(1, 0);
    }
    errors.blocks.push_back(std::move(block));
  }
  return errors;
}

PerClass settled(const ModeErrors& errors, const LevelPrior& prior) {
  PerClass levels = prior.usual;
  for (int round = 0; round < 40; ++round) {
    levels = updated(levels, prior, LevelLikelihood(errors, levels).evidence());
  }
  return levels;
}

TEST(LevelLikelihood, IsThatOfTheDenseCovariance) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Dice dice(seed);
    const ModeErrors errors = some_errors(dice, 3);
    const MatrixXd covariance = dense_covariance(errors, some_levels());
    const LevelLikelihood likelihood(errors, some_levels());
    const double dense = dense_negative_log(covariance, stacked(errors));
    EXPECT_NEAR(likelihood.negative_log(), dense + errors.penalty, 1e-9 * std::abs(dense)) << seed;
    const VectorXd other = dice.normal(stacked(errors).size(), 1);
    EXPECT_NEAR(likelihood.negative_log(other),
                dense_negative_log(covariance, other) + errors.penalty, 1e-8);
    const MatrixXd a = dice.normal(other.size(), 2);
    const MatrixXd b = dice.normal(other.size(), 3);
    const MatrixXd product = a.transpose() * covariance.llt().solve(b);
    EXPECT_LT((likelihood.product(a, b) - product).norm(), 1e-9 * product.norm()) << seed;
  }
}

// What the most probable shared errors leave of each block, by its own covariance.
TEST(LevelLikelihood, KnowsTheSquareOfEachBlock) {
  Dice dice(5);
  ModeErrors errors = some_errors(dice, 3);
  errors.blocks[2].error *= 20.0;
  const LevelLikelihood likelihood(errors, some_levels());
  const VectorXd squares = likelihood.block_squares();
  const MatrixXd covariance = dense_covariance(errors, some_levels());
  ModeErrors alone = errors;
  alone.shared_of.clear();
  for (auto& block : alone.blocks) block.shared.resize(block.count(), 0);
  const MatrixXd own = dense_covariance(alone, some_levels());
  // C⁻¹e = D⁻¹(e − S m): the errors that are left are D C⁻¹e.
  const VectorXd left = own * covariance.llt().solve(stacked(errors));
  Index first = 0;
  for (std::size_t b = 0; b < errors.blocks.size(); ++b) {
    const Index n = errors.blocks[b].count();
    const VectorXd part = left.segment(first, n);
    const double square = part.dot(own.block(first, first, n, n).llt().solve(part));
    EXPECT_NEAR(squares(static_cast<Index>(b)), square, 1e-8 * (1.0 + square)) << b;
    first += n;
  }
  Index worst = 0;
  squares.maxCoeff(&worst);
  EXPECT_EQ(worst, 2);
}

TEST(CovarianceOf, IsABlockOfTheDenseCovariance) {
  Dice dice(6);
  const ModeErrors errors = some_errors(dice, 3);
  const MatrixXd all = dense_covariance(errors, some_levels());
  Index first = 0;
  for (const auto& block : errors.blocks) {
    const MatrixXd own = covariance_of(block, errors.shared_of, some_levels());
    const MatrixXd difference = own - all.block(first, first, block.count(), block.count());
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12) << first;
    first += block.count();
  }
}

TEST(LevelLikelihood, NeedsNoSharedErrors) {
  Dice dice(4);
  ModeErrors errors = some_errors(dice, 2);
  errors.shared_of.clear();
  for (auto& block : errors.blocks) block.shared.resize(block.count(), 0);
  const MatrixXd covariance = dense_covariance(errors, some_levels());
  EXPECT_NEAR(LevelLikelihood(errors, some_levels()).negative_log(),
              dense_negative_log(covariance, stacked(errors)) + errors.penalty, 1e-9);
}

// Blocks that keep their covariance are those of the likelihood, with the errors of the other.
TEST(LevelLikelihood, KeepsTheCovarianceOfBlocksUnderOtherErrors) {
  Dice dice(11);
  const auto errors = some_errors(dice, 2);
  auto other = some_errors(dice, 3);
  other.penalty = 0.4;
  const LevelLikelihood likelihood(errors, some_levels());
  for (const auto& kept : std::vector<std::vector<bool>>{
           {true, true, true}, {false, false, false}, {true, false, true}, {false, true, false}}) {
    ModeErrors expected = other;
    for (std::size_t b = 0; b < kept.size(); ++b) {
      if (!kept[b]) continue;
      expected.blocks[b] = errors.blocks[b];
      expected.blocks[b].error = other.blocks[b].error;
    }
    EXPECT_NEAR(likelihood.negative_log(other, kept),
                LevelLikelihood(expected, some_levels()).negative_log(), 1e-9);
  }
}

// γ = tr(Jᵀ C⁻¹ J) and Σ η²/s² = |Jᵀ C⁻¹ e|², where J are the errors of the class times its level.
// What modes nearby add to a shape is no error of a frequency, though it has their level.
TEST(Evidence, IsThatOfTheDenseCovariance) {
  for (const Index mixed : {0, 3}) {
    Dice dice(5);
    const ModeErrors errors = some_errors(dice, mixed);
    const MatrixXd inverse = dense_covariance(errors, some_levels()).inverse();
    const auto evidence = LevelLikelihood(errors, some_levels()).evidence();
    for (int of = 0; of < static_cast<int>(kErrorClasses); ++of) {
      const MatrixXd own = columns_of(errors, some_levels(), of, false);
      const double determined = (own.transpose() * inverse * own).trace();
      const double size = (own.transpose() * inverse * stacked(errors)).squaredNorm();
      const auto which = name(static_cast<ErrorClass>(of));
      EXPECT_NEAR(evidence.determined(of), determined, 1e-8) << which << ", mixed " << mixed;
      EXPECT_NEAR(evidence.size(of), size, 1e-8 * (1.0 + size)) << which << ", mixed " << mixed;
    }
  }
}

// But for the level of the frequencies where it is also that of the mixing.
bool is_slope(int of, Index mixed) { return of != kFrequency || mixed == 0; }

TEST(Evidence, IsTheSlopeOfTheLikelihood) {
  for (const Index mixed : {0, 3}) {
    Dice dice(6);
    const ModeErrors errors = some_errors(dice, mixed);
    const auto evidence = LevelLikelihood(errors, some_levels()).evidence();
    constexpr double kStep = 1e-5;
    for (int of = 0; of < static_cast<int>(kErrorClasses); ++of) {
      if (!is_slope(of, mixed)) continue;
      const auto value = [&](double step) {
        PerClass levels = some_levels();
        levels(of) *= std::exp(step);
        return LevelLikelihood(errors, levels).negative_log();
      };
      EXPECT_NEAR(evidence.determined(of) - evidence.size(of),
                  (value(kStep) - value(-kStep)) / (2.0 * kStep), 1e-5)
          << name(static_cast<ErrorClass>(of)) << ", mixed " << mixed;
    }
  }
}

TEST(Updated, EndsAtTheSampleDeviationOfManyNumbers) {
  const LevelPrior prior = level_prior(Tolerances{}, true);
  for (const double level : {0.2, 1.0, 5.0}) {
    Dice dice(7);
    const VectorXd error = level * prior.usual(kShape) * dice.normal(400, 1);
    const double sample = std::sqrt(error.squaredNorm() / 400.0);
    const PerClass found = settled(plain(error, kShape), prior);
    EXPECT_NEAR(found(kShape), sample, 0.01 * sample) << level;
    for (int of = 0; of < static_cast<int>(kErrorClasses); ++of) {
      if (of == kShape) continue;
      EXPECT_DOUBLE_EQ(found(of), prior.usual(of)) << "nothing was seen of it";
    }
  }
}

TEST(Updated, StaysNearTheUsualLevelForTwoNumbers) {
  const LevelPrior prior = level_prior(Tolerances{}, true);
  for (const double size : {0.3, 3.0}) {
    const VectorXd error = VectorXd::Constant(2, size * prior.usual(kShape));
    const double off = std::log(settled(plain(error, kShape), prior)(kShape) / prior.usual(kShape));
    EXPECT_GT(off * std::log(size), 0.0) << "toward the sample";
    EXPECT_LT(std::abs(off), 0.9 * std::abs(std::log(size))) << "but not all the way";
  }
}

// Where the levels come to rest, likelihood times prior has no slope.
TEST(Updated, EndsAtTheMostProbableLevels) {
  LevelPrior prior = level_prior(Tolerances{}, true);
  prior.at_most.setConstant(10.0);
  for (const Index mixed : {0, 3}) {
    Dice dice(8);
    const ModeErrors errors = some_errors(dice, mixed);
    const PerClass found = settled(errors, prior);
    constexpr double kStep = 1e-4;
    for (int of = 0; of < static_cast<int>(kErrorClasses); ++of) {
      if (!is_slope(of, mixed)) continue;
      const auto value = [&](double step) {
        PerClass levels = found;
        levels(of) *= std::exp(step);
        const double off = std::log(levels(of) / prior.usual(of)) / prior.width;
        return LevelLikelihood(errors, levels).negative_log() + 0.5 * off * off;
      };
      EXPECT_NEAR((value(kStep) - value(-kStep)) / (2.0 * kStep), 0.0, 1e-3)
          << name(static_cast<ErrorClass>(of)) << ", mixed " << mixed;
    }
  }
}

TEST(Updated, BelievesNoMoreThanTheLargestLevel) {
  const LevelPrior prior = level_prior(Tolerances{}, true);
  const PerClass found = settled(plain(VectorXd::Constant(50, 3.0), kShape), prior);
  EXPECT_EQ(found(kShape), prior.at_most(kShape));
}

TEST(Updated, MovesNoLevelThatIsKnown) {
  const Tolerances tolerances;
  const LevelPrior prior = level_prior(tolerances, false);
  EXPECT_EQ(prior.width, 0.0);
  EXPECT_EQ(prior.usual(kFrequency), tolerances.frequency);
  Dice dice(9);
  const ModeErrors errors = some_errors(dice, 3);
  const auto evidence = LevelLikelihood(errors, prior.usual).evidence();
  EXPECT_TRUE((updated(prior.usual, prior, evidence) == prior.usual).all());
  EXPECT_EQ(negative_log_prior(prior.usual, prior, evidence), 0.0);
}

// Laplace's integral over the level beside the sum over a grid of 40 levels.
TEST(NegativeLogPrior, IntegratesTheLevel) {
  LevelPrior prior = level_prior(Tolerances{}, true);
  prior.at_most.setConstant(10.0);
  for (const Index count : {2, 6, 24}) {
    for (const double level : {0.3, 1.0, 4.0}) {
      Dice dice(10);
      const VectorXd error = level * prior.usual(kShape) * dice.normal(count, 1);
      const ModeErrors errors = plain(error, kShape);
      const PerClass found = settled(errors, prior);
      const LevelLikelihood best(errors, found);
      const double laplace =
          best.negative_log() + negative_log_prior(found, prior, best.evidence());
      double sum = 0.0;
      constexpr int kGrid = 40;
      const double step = 8.0 * prior.width / kGrid;
      for (int i = 0; i < kGrid; ++i) {
        const double off = (i + 0.5) * step - 4.0 * prior.width;
        PerClass levels = prior.usual;
        levels(kShape) *= std::exp(off);
        sum += step / (prior.width * std::sqrt(2.0 * std::numbers::pi)) *
               std::exp(-0.5 * std::pow(off / prior.width, 2) + best.negative_log() -
                        LevelLikelihood(errors, levels).negative_log());
      }
      EXPECT_NEAR(laplace, best.negative_log() - std::log(sum), 0.3) << count << ", " << level;
    }
  }
}

}  // namespace
}  // namespace chladni::diagnosis
