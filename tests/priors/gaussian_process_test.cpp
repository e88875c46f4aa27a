#include "priors/gaussian_process/gaussian_process.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"

namespace chladni::priors {
namespace {

constexpr unsigned kSeed = 7;

Points random_points(Eigen::Index count, unsigned seed = kSeed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  Points points = Points::Constant(count, 3, 0.01);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int a = 0; a < 2; ++a) points(i, a) = uniform(random);
  }
  return points;
}

Eigen::MatrixXd shapes(const Points& points, Eigen::Index count) {
  Eigen::MatrixXd values(points.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double k = 4.0 + static_cast<double>(i);
    values.col(i) = (k * points.col(0).array()).sin() * (0.7 * k * points.col(1).array()).cos() +
                    0.3 * points.col(0).array();
  }
  return values;
}

GaussianPrior prior(const Points& points, bool with_trend, double amplitude = 1.3) {
  GaussianPrior prior{Kernel(kernel_family("matern_5_2"), Scales::per_axis),
                      Eigen::Vector3d(0.2, 0.3, 0.25),
                      amplitude,
                      {}};
  if (with_trend) prior.trend = rigid_trend(points, Eigen::RowVector3d::UnitZ());
  return prior;
}

Eigen::VectorXd noise(Eigen::Index count) { return Eigen::VectorXd::LinSpaced(count, 1e-3, 4e-3); }

Eigen::MatrixXd whole(const Eigen::MatrixXd& lower) {
  return lower.selfadjointView<Eigen::Lower>();
}

// C of the textbook.
Eigen::MatrixXd full_covariance(const GaussianPrior& p, const Points& at,
                                const Eigen::VectorXd& noise_variance) {
  Eigen::MatrixXd c = p.amplitude * p.amplitude * whole(covariance(p.kernel, p.parameters, at));
  c.diagonal() += noise_variance;
  return c;
}

TEST(GaussianProcess, IsTheTextbooksFormula) {
  const auto points = random_points(9);
  const auto places = random_points(5, kSeed + 1);
  const auto p = prior(points, false);
  const auto y = shapes(points, 2);
  const Eigen::MatrixXd c = full_covariance(p, points, noise(9));
  const Eigen::MatrixXd inverse = c.inverse();
  const Eigen::MatrixXd across =
      p.amplitude * p.amplitude * covariance(p.kernel, p.parameters, places, points);
  const GaussianProcess process(p, points, noise(9));
  const auto found = process.at(places, y);
  EXPECT_LT((found.mean - across * inverse * y).norm(), 1e-12);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double variance =
        p.amplitude * p.amplitude - across.row(i) * inverse * across.row(i).transpose();
    EXPECT_NEAR(found.deviation(i) * found.deviation(i), variance, 1e-12);
  }
  const auto score = process.score(Merit::marginal_likelihood, y);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double expected = -0.5 * y.col(i).dot(inverse * y.col(i)) -
                            0.5 * std::log(c.determinant()) -
                            4.5 * std::log(2.0 * std::numbers::pi);
    EXPECT_NEAR(score.value(i), expected, 1e-10);
  }
  EXPECT_EQ(process.jitter(), 0.0);
}

TEST(GaussianProcess, InterpolatesWithoutNoise) {
  for (const bool with_trend : {false, true}) {
    const auto points = random_points(20);
    const auto y = shapes(points, 3);
    const GaussianProcess process(prior(points, with_trend), points, Eigen::VectorXd::Zero(20));
    const auto found = process.at(points, y);
    EXPECT_LT((found.mean - y).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT(found.deviation.maxCoeff(), 1e-6);
  }
}

TEST(GaussianProcess, MeanIsItsWeightsTimesTheValues) {
  for (const bool with_trend : {false, true}) {
    const auto points = random_points(12);
    const auto places = random_points(30, kSeed + 2);
    const auto y = shapes(points, 2);
    const GaussianProcess process(prior(points, with_trend), points, noise(12));
    EXPECT_LT((process.weights(places) * y - process.at(places, y).mean).norm(), 1e-11);
  }
}

// A free coefficient is the limit of one with a prior of large variance.
TEST(GaussianProcess, FreeTrendIsTheLimitOfAWidePrior) {
  const auto points = random_points(12);
  const auto places = random_points(30, kSeed + 2);
  const auto y = shapes(points, 2);
  const auto p = prior(points, true);
  const GaussianProcess process(p, points, noise(12));
  const auto found = process.at(places, y);
  const double wide = 1e6;
  const Eigen::MatrixXd h = p.trend.at(points);
  const Eigen::MatrixXd there = p.trend.at(places);
  const Eigen::MatrixXd c = full_covariance(p, points, noise(12)) + wide * h * h.transpose();
  const Eigen::MatrixXd across =
      p.amplitude * p.amplitude * covariance(p.kernel, p.parameters, places, points) +
      wide * there * h.transpose();
  EXPECT_LT((found.mean - across * c.ldlt().solve(y)).cwiseAbs().maxCoeff(), 1e-5);
  for (Eigen::Index i = 0; i < 30; ++i) {
    const double variance = p.amplitude * p.amplitude + wide * there.row(i).squaredNorm() -
                            across.row(i) * c.ldlt().solve(across.row(i).transpose());
    EXPECT_NEAR(found.deviation(i) * found.deviation(i), variance, 1e-3 * variance + 1e-6);
  }
}

TEST(GaussianProcess, ReproducesPlanesWithATrend) {
  const auto points = random_points(12);
  const auto places = random_points(30, kSeed + 3);
  const auto plane = [](const Points& at) -> Eigen::VectorXd {
    return 3.0 + 2.0 * at.col(0).array() - 7.0 * at.col(1).array();
  };
  const GaussianProcess process(prior(points, true), points, noise(12));
  EXPECT_LT((process.at(places, plane(points)).mean - plane(places)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(GaussianProcess, RestrictedLikelihoodIsThatOfWhatTheTrendLeaves) {
  const auto points = random_points(10);
  const auto y = shapes(points, 1);
  const auto p = prior(points, true);
  const Eigen::MatrixXd h = p.trend.at(points);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(h);
  const Eigen::MatrixXd all = qr.householderQ();
  const Eigen::MatrixXd rest = all.rightCols(7);
  const Eigen::MatrixXd c = rest.transpose() * full_covariance(p, points, noise(10)) * rest;
  const Eigen::VectorXd z = rest.transpose() * y;
  const double expected = -0.5 * z.dot(c.inverse() * z) - 0.5 * std::log(c.determinant()) -
                          3.5 * std::log(2.0 * std::numbers::pi);
  const GaussianProcess process(p, points, noise(10));
  EXPECT_NEAR(process.score(Merit::marginal_likelihood, y).value(0), expected, 1e-9);
}

TEST(GaussianProcess, BestFactorIsTheBest) {
  const auto points = random_points(14);
  const auto y = shapes(points, 3);
  for (const auto merit : {Merit::marginal_likelihood, Merit::leave_one_out}) {
    const auto p = prior(points, true);
    const auto best = GaussianProcess(p, points, noise(14)).score(merit, y, true);
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (const double off : {0.99, 1.0, 1.01}) {
        const double b = off * best.factor(i);
        auto scaled = p;
        scaled.amplitude *= b;
        const GaussianProcess process(scaled, points, b * b * noise(14));
        const double value = process.score(merit, y.col(i)).value(0);
        if (off == 1.0) {
          EXPECT_NEAR(value, best.value(i), 1e-9);
        } else {
          EXPECT_LT(value, best.value(i));
        }
      }
    }
  }
}

TEST(GaussianProcess, LeaveOneOutIsTheRefitWithoutThePoint) {
  for (const bool with_trend : {false, true}) {
    const auto points = random_points(11);
    const auto y = shapes(points, 2);
    const auto p = prior(points, with_trend);
    const GaussianProcess process(p, points, noise(11));
    const auto found = process.leave_one_out(y);
    Eigen::Vector2d density = Eigen::Vector2d::Zero();
    for (Eigen::Index i = 0; i < 11; ++i) {
      std::vector<Eigen::Index> others;
      for (Eigen::Index k = 0; k < 11; ++k) {
        if (k != i) others.push_back(k);
      }
      const Points rest = points(others, Eigen::all);
      const GaussianProcess refit(p, rest, noise(11)(others));
      const auto there = refit.at(points.row(i), y(others, Eigen::all));
      const double variance = there.deviation(0) * there.deviation(0) + noise(11)(i);
      EXPECT_NEAR(found.variance(i), variance, 1e-9);
      for (Eigen::Index m = 0; m < 2; ++m) {
        EXPECT_NEAR(found.mean(i, m), there.mean(0, m), 1e-9);
        const double off = y(i, m) - there.mean(0, m);
        density(m) -= 0.5 * (std::log(2.0 * std::numbers::pi * variance) + off * off / variance);
      }
    }
    const auto score = process.score(Merit::leave_one_out, y);
    EXPECT_LT((score.value - density).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(GaussianProcess, SlopesAreDifferences) {
  const auto points = random_points(13);
  const auto y = shapes(points, 3);
  const Eigen::VectorXd factor = Eigen::Vector3d(1.0, 0.8, 1.2);
  const double h = 1e-4;
  for (const auto merit : {Merit::marginal_likelihood, Merit::leave_one_out}) {
    for (const bool with_trend : {false, true}) {
      const auto p = prior(points, with_trend);
      // The scores with ln of parameter k (then of the amplitude, then of the noise) moved by d.
      const auto score = [&](Eigen::Index k, double d) -> Eigen::VectorXd {
        auto moved = p;
        double louder = 1.0;
        if (k < 3) moved.parameters(k) *= std::exp(d);
        if (k == 3) moved.amplitude *= std::exp(d);
        if (k == 4) louder = std::exp(d);
        const GaussianProcess process(moved, points, louder * noise(13));
        return process.score(merit, y * factor.cwiseInverse().asDiagonal()).value;
      };
      const auto exact = GaussianProcess(p, points, noise(13)).slopes(merit, y, factor);
      for (Eigen::Index k = 0; k < 5; ++k) {
        const Eigen::VectorXd difference =
            (8.0 * (score(k, h) - score(k, -h)) - (score(k, 2.0 * h) - score(k, -2.0 * h))) /
            (12.0 * h);
        const Eigen::VectorXd slope = k < 3 ? Eigen::VectorXd(exact.parameters.row(k).transpose())
                                            : (k == 3 ? exact.amplitude : exact.noise);
        EXPECT_LT((slope - difference).cwiseAbs().maxCoeff(), 1e-6 * (1.0 + slope.norm()))
            << "parameter " << k << ", trend " << with_trend;
      }
    }
  }
}

TEST(GaussianProcess, SeveralOutputsAreSingleOnes) {
  const auto points = random_points(13);
  const auto places = random_points(8, kSeed + 4);
  const auto y = shapes(points, 3);
  const GaussianProcess process(prior(points, true), points, noise(13));
  for (const auto merit : {Merit::marginal_likelihood, Merit::leave_one_out}) {
    const auto all = process.score(merit, y, true);
    const auto slopes = process.slopes(merit, y, all.factor);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto one = process.score(merit, y.col(i), true);
      EXPECT_NEAR(all.value(i), one.value(0), 1e-10);
      EXPECT_NEAR(all.factor(i), one.factor(0), 1e-12);
      const auto slope = process.slopes(merit, y.col(i), one.factor);
      EXPECT_LT((slopes.parameters.col(i) - slope.parameters).norm(), 1e-9);
    }
  }
  const auto together = process.at(places, y);
  EXPECT_LT((together.mean.col(1) - process.at(places, y.col(1)).mean).norm(), 1e-12);
}

TEST(GaussianProcess, SingularMatrixIsHandledAndSaid) {
  auto points = random_points(40);
  points.row(39) = points.row(0);
  GaussianPrior p{kernel_family("squared_exponential"), Eigen::VectorXd::Constant(1, 3.0), 1.0, {}};
  const Eigen::VectorXd y = points.col(0).array().square();
  const GaussianProcess process(p, points, Eigen::VectorXd::Zero(40));
  EXPECT_GT(process.jitter(), 0.0);
  EXPECT_LE(process.jitter(), 1e-8);
  EXPECT_LT((process.at(points, y).mean - y).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(GaussianProcess, OnALineHasATrendAlongIt) {
  Points line = Points::Zero(8, 3);
  line.col(0) = Eigen::VectorXd::LinSpaced(8, 0.0, 0.5);
  const auto trend = rigid_trend(line, Eigen::RowVector3d::UnitZ());
  EXPECT_EQ(trend.count(), 2);
  const GaussianProcess process(
      {kernel_family("squared_exponential"), Eigen::VectorXd::Constant(1, 0.1), 1.0, trend}, line,
      Eigen::VectorXd::Constant(8, 1e-6));
  const Eigen::VectorXd y = 1.0 + 4.0 * line.col(0).array();
  EXPECT_LT((process.at(line, y).mean - y).cwiseAbs().maxCoeff(), 1e-10);
  Points beyond = Points::Zero(1, 3);
  beyond(0, 0) = 1.0;
  EXPECT_NEAR(process.at(beyond, y).mean(0), 5.0, 1e-9);
}

TEST(RigidTrend, HasNoFunctionAlongTheDirectionItself) {
  Points points = random_points(20);
  points.col(2) = points.col(0).array().square();
  EXPECT_EQ(rigid_trend(points, Eigen::RowVector3d::UnitZ()).count(), 3);
  EXPECT_LT(rigid_trend(points, Eigen::RowVector3d::UnitZ()).slopes.row(2).norm(), 1e-12);
  EXPECT_EQ(rigid_trend(points.topRows(1), Eigen::RowVector3d::UnitZ()).count(), 1);
}

TEST(BestAmplitude, MaximisesTheLikelihood) {
  const auto points = random_points(13);
  const Eigen::VectorXd y = 2.5 * shapes(points, 1);
  for (const bool with_trend : {false, true}) {
    auto p = prior(points, with_trend, 1.0);
    const double best = best_amplitude(covariance(p.kernel, p.parameters, points), noise(13),
                                       p.trend.at(points), y);
    const auto value = [&](double amplitude) {
      auto there = p;
      there.amplitude = amplitude;
      return GaussianProcess(there, points, noise(13))
          .score(Merit::marginal_likelihood, y)
          .value(0);
    };
    EXPECT_GT(value(best), value(1.01 * best));
    EXPECT_GT(value(best), value(best / 1.01));
  }
}

TEST(GaussianProcess, RefusesWhatDoesNotFit) {
  const auto points = random_points(3);
  EXPECT_THROW(GaussianProcess(prior(points, false), points, noise(4)), InvalidInput);
  EXPECT_THROW(GaussianProcess(prior(points, true), points, noise(3)), InvalidInput);
  EXPECT_THROW(GaussianProcess(prior(points, false), points, -noise(3)), InvalidInput);
  EXPECT_THROW(GaussianProcess(prior(points, false, 0.0), points, noise(3)), InvalidInput);
  const GaussianProcess process(prior(points, false), points, noise(3));
  EXPECT_THROW((void)process.at(points, Eigen::VectorXd::Ones(4)), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
