#include "diagnosis/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
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

// Whichever was found first: a mass with inertia and a gain, or the gain and the mass.
TEST(Explanations, PutTheSimplerOfTwoThatExplainAsWellFirst) {
  const auto& plate = small_plate();
  const Supposed gain{&effect("sensor_gain"), 2, VectorXd::Constant(1, std::log(1.2))};
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  const Supposed wide{&effect("mass_with_inertia"), 0,
                      Eigen::Vector4d(std::log(0.04), std::log(1e-3), 0.1, -0.05)};
  const std::vector<Deviation> none;
  Observed observed;
  observed.outputs = plate.output_count();
  observed.inputs = plate.input_count();
  observed.omega = some_lines();
  State truth = state_of(plate);
  for (const auto& cause : {gain, mass}) change_of(cause, plate)(truth);
  observed.value = responses(truth, observed.omega);
  observed.weight = 100.0 * observed.value.cwiseAbs().cwiseInverse();
  const Problem problem{plate, observed, none};
  const auto fit_of = [&](std::vector<Supposed> causes) {
    Fit start;
    start.causes = std::move(causes);
    return fitted(problem, start);
  };
  Found found;
  found.nothing = fit_of({});
  found.fits = {fit_of({wide, gain}), fit_of({gain, mass}), found.nothing};
  const auto told = explanations(problem, found, 20.0);
  ASSERT_EQ(told.front().causes.size(), 2U);
  EXPECT_EQ(told.front().causes.back().effect, "point_mass");
  EXPECT_EQ(judged(problem, found, told, {}), Verdict::named);
}

}  // namespace
}  // namespace chladni::diagnosis
