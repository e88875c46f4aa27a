#include "diagnosis/modes/errors/covariance_slopes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using simulators::Dice;

PerClass levels() { return PerClass::Constant(0.05); }

// Blocks of shapes with errors that they share.
ModeErrors blocks_of(Dice& dice) {
  ModeErrors errors;
  const auto of = [](ErrorClass which) { return static_cast<int>(which); };
  errors.shared_of = {of(ErrorClass::gain), -1, of(ErrorClass::place)};
  for (const Index n : {4, 1, 6}) {
    ModeBlock block;
    block.error = dice.normal(n, 1);
    block.noise = Eigen::VectorXd::Constant(n, 0.02);
    block.of.assign(static_cast<std::size_t>(n), of(ErrorClass::shape));
    block.weight.assign(static_cast<std::size_t>(n), 1.0);
    block.free = dice.normal(n, 1);
    block.mixed = dice.normal(n, 2);
    block.shared = dice.normal(n, 3);
    errors.blocks.push_back(std::move(block));
  }
  return errors;
}

ModeErrors moved(const ModeErrors& here, double step, Dice& dice) {
  ModeErrors there = here;
  for (auto& block : there.blocks) {
    block.shared += step * dice.normal(block.count(), block.shared.cols());
    block.mixed += step * dice.normal(block.count(), block.mixed.cols());
  }
  return there;
}

// 1/2 tr(C⁻¹ dC C⁻¹ dC) of each block, for two coordinates.
TEST(CovarianceSlopes, MakeTheInformationOfEachBlock) {
  Dice dice(7);
  const double step = 0.1;
  const ModeErrors here = blocks_of(dice);
  const std::vector<ModeErrors> there{moved(here, step, dice), moved(here, step, dice)};
  const auto information = [&](const ModeErrors& one, const ModeErrors& other) {
    double sum = 0.0;
    for (std::size_t b = 0; b < here.blocks.size(); ++b) {
      const auto of = [&](const ModeErrors& errors) {
        return covariance_of(errors.blocks[b], errors.shared_of, levels());
      };
      const MatrixXd own = of(here);
      const MatrixXd inverse = own.inverse();
      const MatrixXd first = inverse * (of(one) - own) / step;
      const MatrixXd second = inverse * (of(other) - own) / step;
      sum += 0.5 * first.cwiseProduct(second.transpose()).sum();
    }
    return sum;
  };
  const CovarianceSlopes slopes(here, levels());
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const double expected = information(there[i], there[j]);
      const double found = 0.5 * slopes.of(there[i], step).dot(slopes.of(there[j], step));
      EXPECT_NEAR(found, expected, 1e-8 * (1.0 + std::abs(expected))) << i << j;
    }
  }
}

// n numbers of the deviation s exp(x) tell x to 1 / sqrt(2 n).
TEST(CovarianceSlopes, KnowADeviationByTheCountOfItsNumbers) {
  const double step = 1e-6;
  ModeErrors here;
  ModeErrors there;
  const int count = 12;
  for (int i = 0; i < count; ++i) {
    ModeBlock block;
    block.error = block.noise = Eigen::VectorXd::Zero(1);
    block.of = {static_cast<int>(ErrorClass::shape)};
    block.weight = {1.0};
    here.blocks.push_back(block);
    block.weight = {std::exp(step)};
    there.blocks.push_back(block);
  }
  const Eigen::VectorXd slope = CovarianceSlopes(here, levels()).of(there, step);
  EXPECT_NEAR(0.5 * slope.squaredNorm(), 2.0 * count, 1e-4);
}

}  // namespace
}  // namespace chladni::diagnosis
