#include "priors/learning.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "base/error.h"
#include "priors/gaussian_process/line_search.h"

namespace chladni::priors {
namespace {

Points learning_grid(int per_side, double size) {
  Points points = Points::Zero(Eigen::Index{per_side} * per_side, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points(i, 0) = size * (static_cast<double>(i % per_side) / (per_side - 1) - 0.5);
    points(i, 1) = size * (static_cast<double>(i / per_side) / (per_side - 1) - 0.5);
  }
  return points;
}

// Shapes that are draws of the kernel, times `sigma`.
Eigen::MatrixXd drawn(const Kernel& kernel, const Eigen::VectorXd& parameters, const Points& at,
                      double sigma, double noise, Eigen::Index count, unsigned seed) {
  Eigen::MatrixXd matrix = covariance(kernel, parameters, at).selfadjointView<Eigen::Lower>();
  matrix.diagonal().array() += 1e-10 + noise * noise;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd white =
      Eigen::MatrixXd::NullaryExpr(at.rows(), count, [&] { return normal(random); });
  const Eigen::MatrixXd factor = matrix.llt().matrixL();
  return sigma * factor * white;
}

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(Learned, FindsTheHyperparametersOfItsOwnDraws) {
  const Kernel kernel(kernel_family("matern_3_2"));
  const auto points = learning_grid(17, 0.6);
  const auto y = drawn(kernel, one(0.12), points, 2.0, 0.0, 12, 3);
  const auto found = learned(kernel, points, y, {.shared = true});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].parameters(0) / 0.12, 1.0, 0.1);
  EXPECT_NEAR(found[0].sigma / 2.0, 1.0, 0.1);
  EXPECT_TRUE(found[0].at_bound.empty());
}

TEST(Learned, FindsTheNoiseToo) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const auto points = learning_grid(12, 0.6);
  const auto y = drawn(kernel, one(0.15), points, 1.0, 0.05, 6, 4);
  const auto found = learned(kernel, points, y, {.shared = true, .learn_noise = true});
  EXPECT_NEAR(found[0].noise / 0.05, 1.0, 0.15);
  EXPECT_NEAR(found[0].parameters(0) / 0.15, 1.0, 0.15);
}

TEST(Learned, NoOtherLengthIsLikelier) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const auto points = learning_grid(9, 0.6);
  const auto y = drawn(kernel, one(0.15), points, 1.0, 0.0, 4, 5);
  for (const auto merit : {Merit::marginal_likelihood, Merit::leave_one_out}) {
    const auto found = learned(kernel, points, y, {.merit = merit, .noise_ratio = 1e-6});
    ASSERT_EQ(found.size(), 4U);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto& best = found[static_cast<std::size_t>(i)];
      for (double length = 0.03; length < 1.5; length *= 1.02) {
        const GaussianProcess there({kernel, one(length), 1.0, {}}, points,
                                    Eigen::VectorXd::Constant(81, 1e-6));
        EXPECT_LE(there.score(merit, y.col(i), true).value(0), best.score + 1e-3) << length;
      }
    }
  }
}

// The line search and the gradient-based one are two ways to one answer.
TEST(Learned, IsTheSameOnALineAndInABox) {
  const Kernel kernel(kernel_family("matern_5_2"));
  const auto points = learning_grid(8, 0.6);
  const auto y = drawn(kernel, one(0.2), points, 1.5, 0.02, 2, 6);
  const Eigen::MatrixXd noise = Eigen::MatrixXd::Constant(64, 2, 0.03);
  const auto line = learned(kernel, points, y, {.noise = noise});
  // A weight that only scales the amplitude makes a second parameter.
  const auto box = learned(weighted(kernel), points, y, {.noise = noise, .starts = 2});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::log(line[i].parameters(0) / box[i].parameters(0)), 0.0, 1e-2);
    EXPECT_NEAR(line[i].sigma, box[i].sigma * std::sqrt(box[i].parameters(1)), 0.02);
    EXPECT_NEAR(line[i].score, box[i].score, 1e-3);
  }
}

TEST(Learned, ScalesWithTheValuesAndTheBody) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const auto points = learning_grid(8, 0.6);
  const auto y = drawn(kernel, one(0.15), points, 1.0, 0.0, 2, 7);
  const auto first = learned(kernel, points, y);
  const Points larger = 3.0 * points;
  const auto scaled = learned(kernel, larger, 10.0 * y);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(scaled[i].parameters(0) / first[i].parameters(0), 3.0, 1e-6);
    EXPECT_NEAR(scaled[i].sigma / first[i].sigma, 10.0, 1e-4);
  }
}

TEST(Learned, PriorsPullAndBoundsAreSaid) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const auto points = learning_grid(6, 0.6);
  const auto y = drawn(kernel, one(0.2), points, 1.0, 0.0, 1, 8);
  const auto free = learned(kernel, points, y);
  Learning how;
  how.priors = {{0.4, 1e-3}};
  const auto pulled = learned(kernel, points, y, how);
  EXPECT_NEAR(pulled[0].parameters(0), 0.4, 1e-3);
  EXPECT_GT(std::abs(free[0].parameters(0) - 0.4), 0.05);
  const auto bounded = learned(kernel, points, y, {.length_range = {0.5, 1.0}});
  EXPECT_EQ(bounded[0].at_bound, std::vector<std::string>{"length_scale"});
  EXPECT_NEAR(bounded[0].parameters(0), 0.5, 0.01);
}

// A shape without noise that is smoother than any draw: what is learned is what the ratio says.
TEST(NoiseDependence, TellsARidgeFromDraws) {
  const auto points = learning_grid(14, 0.6);
  const Kernel rough(kernel_family("matern_3_2"));
  const auto draws = drawn(rough, one(0.15), points, 1.0, 0.0, 2, 12);
  EXPECT_LT(noise_dependence(learned(rough, points, draws), rough, points, draws, {}).maxCoeff(),
            0.05);
  const Kernel kernel(kernel_family("squared_exponential"));
  const Eigen::VectorXd shape =
      (10.0 * points.col(0).array()).sin() * (7.0 * points.col(1).array()).cos();
  EXPECT_GT(noise_dependence(learned(kernel, points, shape), kernel, points, shape, {})(0), 0.1);
}

// Points in a plane tell nothing of the length across it, which stays where its search began.
TEST(NoiseDependence, DoesNotCountALengthThatNoPointTells) {
  const Kernel rough(kernel_family("matern_3_2"), Scales::per_axis);
  auto points = learning_grid(10, 0.6);
  points.col(2).setZero();
  const auto draws = drawn(rough, Eigen::Vector3d(0.15, 0.3, 1.0), points, 1.0, 0.0, 4, 12);
  const auto change = noise_dependence(learned(rough, points, draws), rough, points, draws, {});
  EXPECT_LT(change.maxCoeff(), 0.05) << change.transpose();
}

TEST(NoiseDependence, TellsARidgeOfOneLengthPerAxis) {
  const Kernel smooth(kernel_family("squared_exponential"), Scales::per_axis);
  const auto points = learning_grid(10, 0.6);
  const Eigen::VectorXd shape =
      (10.0 * points.col(0).array()).sin() * (7.0 * points.col(1).array()).cos();
  EXPECT_GT(noise_dependence(learned(smooth, points, shape), smooth, points, shape, {})(0), 0.1);
}

TEST(Learned, SeveralHyperparametersAreLikelierThanOne) {
  const Kernel per_axis(kernel_family("squared_exponential"), Scales::per_axis);
  const auto points = learning_grid(9, 0.6);
  const auto y = drawn(per_axis, Eigen::Vector3d(0.1, 0.3, 1.0), points, 1.0, 0.0, 3, 9);
  const auto isotropic = learned(kernel_family("squared_exponential"), points, y,
                                 {.shared = true, .noise_ratio = 1e-6});
  const auto found = learned(per_axis, points, y, {.shared = true, .noise_ratio = 1e-6});
  EXPECT_GT(found[0].log_likelihood, isotropic[0].log_likelihood + 10.0);
  EXPECT_NEAR(found[0].parameters(0) / 0.1, 1.0, 0.15);
  EXPECT_NEAR(found[0].parameters(1) / 0.3, 1.0, 0.2);
}

TEST(Learned, WarmStartNeedsOneSearch) {
  const Kernel kernel(kernel_family("rational_quadratic"));
  const auto points = learning_grid(8, 0.6);
  const auto y = drawn(kernel, Eigen::Vector2d(0.15, 1.0), points, 1.0, 0.0, 3, 10);
  const Learning cold{.shared = true, .noise_ratio = 1e-6};
  const auto first = learned(kernel, points, y, cold);
  auto warm = cold;
  warm.start = first[0].parameters;
  warm.starts = 1;
  const auto again = learned(kernel, points, y, warm);
  EXPECT_NEAR(again[0].score, first[0].score, 1e-3);
  EXPECT_LT(again[0].evaluations, first[0].evaluations / 3);
}

TEST(Learned, SeedDecidesAlone) {
  const Kernel kernel(kernel_family("rational_quadratic"));
  const auto points = learning_grid(6, 0.6);
  const auto y = drawn(kernel, Eigen::Vector2d(0.15, 1.0), points, 1.0, 0.0, 1, 11);
  const auto a = learned(kernel, points, y, {.seed = 5});
  const auto b = learned(kernel, points, y, {.seed = 5});
  EXPECT_EQ(a[0].parameters, b[0].parameters);
}

TEST(Learned, RefusesWhatCannotBeMeant) {
  const Kernel kernel(kernel_family("squared_exponential"));
  const auto points = learning_grid(4, 0.6);
  const Eigen::VectorXd y = points.col(0);
  EXPECT_THROW((void)learned(kernel, points, y.head(5)), InvalidInput);
  EXPECT_THROW((void)learned(kernel, points, Eigen::VectorXd::Zero(16)), InvalidInput);
  EXPECT_THROW((void)learned(kernel, points, y, {.noise_ratio = 1e-12}), InvalidInput);
  EXPECT_THROW((void)learned(kernel, points, y, {.length_range = {2.0, 1.0}}), InvalidInput);
  EXPECT_THROW((void)learned(kernel, points, y, {.noise = -Eigen::MatrixXd::Ones(16, 1)}),
               InvalidInput);
  EXPECT_THROW((void)learned(kernel, Points::Zero(16, 3), y), InvalidInput);
}

TEST(MatchedLength, IsTheBestForTheTask) {
  const auto places = learning_grid(4, 0.5);
  const auto surface = learning_grid(15, 0.6);
  const auto shapes = [](const Points& at) {
    Eigen::MatrixXd values(at.rows(), 2);
    values.col(0) = (9.0 * at.col(0).array()).sin() * (5.0 * at.col(1).array()).cos();
    values.col(1) = (7.0 * at.col(0).array()).cos() * (8.0 * at.col(1).array()).sin();
    return values;
  };
  Task task{places, shapes(places), surface, shapes(surface), Eigen::VectorXd::Ones(225)};
  const auto found = matched_length(kernel_family("squared_exponential"), task);
  EXPECT_FALSE(found.at_bound);
  EXPECT_LT(found.error, 0.05);
  EXPECT_EQ(found.error, found.errors.minCoeff());
  EXPECT_GT(found.errors(0), 0.3);  // far too short: nothing between the places
}

TEST(MatchedLength, NoiseThatIsLargeIsCounted) {
  const auto places = learning_grid(4, 0.5);
  const auto surface = learning_grid(11, 0.6);
  const Eigen::VectorXd here = (6.0 * places.col(0).array()).sin();
  const Eigen::VectorXd there = (6.0 * surface.col(0).array()).sin();
  Task task{places, here, surface, there, Eigen::VectorXd::Ones(121)};
  const auto quiet = matched_length(kernel_family("squared_exponential"), task);
  task.noise = 0.3;
  const auto loud = matched_length(kernel_family("squared_exponential"), task);
  EXPECT_GT(loud.error, 3.0 * quiet.error);
}

TEST(MaximaOnALine, FindsTheHighestOfSeveralHills) {
  int calls = 0;
  const auto values = [&](double x) -> Eigen::VectorXd {
    ++calls;
    return Eigen::Vector3d(-std::pow(x - 0.3, 2), std::sin(5.0 * x) + 0.2 * x, x);
  };
  const auto found = maxima_on_a_line(values, -2.0, 2.0, 15, 1e-5);
  EXPECT_NEAR(found.maxima[0].at, 0.3, 1e-5);
  EXPECT_NEAR(std::cos(5.0 * found.maxima[1].at), -0.04, 2e-4);
  EXPECT_GT(found.maxima[1].at, 1.0);
  EXPECT_EQ(found.maxima[2].at, 2.0);
  EXPECT_EQ(found.evaluations, calls);
  EXPECT_LT(calls, 40);
}

}  // namespace
}  // namespace chladni::priors
