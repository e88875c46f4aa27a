#include "diagnosis/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

// Twenty thousand numbers, of which nothing but their count is asked.
class JudgedVerdict : public testing::Test {
 protected:
  JudgedVerdict() {
    observed_.outputs = observed_.inputs = 1;
    observed_.omega = VectorXd::LinSpaced(10000, 1.0, 1000.0);
    observed_.value = Eigen::MatrixXcd::Zero(10000, 1);
    observed_.weight = Eigen::MatrixXd::Ones(10000, 1);
    found_.nothing.chi_square = 1e6;
  }

  Verdict with(std::size_t causes, double excess, double error_excess = 0.0) const {
    Explanation best;
    best.causes.resize(causes);
    best.excess = excess;
    best.error_excess = error_excess;
    best.strained = 2e4 + excess * std::sqrt(4e4);
    return judged({small_plate(), observed_, none_}, found_, {best}, {});
  }

 private:
  Observed observed_;
  Found found_;
  std::vector<Deviation> none_;
};

TEST_F(JudgedVerdict, NamesWhatLeavesNoise) {
  for (const std::size_t causes : {1U, 2U, 3U}) {
    EXPECT_EQ(with(causes, 0.0), Verdict::named) << causes;
    EXPECT_EQ(with(causes, -3.0), Verdict::named) << causes;
    EXPECT_EQ(with(causes, 20.0), Verdict::partial) << causes;
  }
  EXPECT_EQ(with(0, 2.5), Verdict::no_discrepancy);
  EXPECT_EQ(with(0, 6.0), Verdict::unexplained);
  EXPECT_EQ(with(2, 2000.0), Verdict::unexplained);
}

// Three causes that still leave 2.7 deviations are rarer than a thing that nobody thought of.
TEST_F(JudgedVerdict, BelievesALongStoryLess) {
  EXPECT_EQ(with(1, 2.7), Verdict::named);
  EXPECT_EQ(with(3, 2.7), Verdict::partial);
}

TEST_F(JudgedVerdict, TakesErrorsOfItsOwnEffectsForNoReasonToDoubt) {
  EXPECT_EQ(with(2, 30.0), Verdict::partial);
  EXPECT_EQ(with(2, 30.0, 29.0), Verdict::named);
}

}  // namespace
}  // namespace chladni::diagnosis
