#include "priors/spline/smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "priors/spline/thin_plate_spline.h"
#include "simulators/portable_random.h"

namespace chladni::priors {
namespace {

using simulators::Dice;

// Places in the plane, noise that differs from place to place, values that bend.
struct SmootherCase {
  Eigen::MatrixXd places, kernel, trend;
  Eigen::VectorXd deviation, values;

  explicit SmootherCase(int n = 13, unsigned seed = 5, Eigen::Index dimensions = 2) {
    Dice dice(seed);
    places = dice.normal(n, dimensions);
    kernel = bending_kernel(places, places);
    trend = plane_functions(places);
    deviation.resize(n);
    for (double& d : deviation) d = dice.between(0.5, 2.0);
    values = (2.0 * places.col(0)).array().sin() + places.rowwise().squaredNorm().array();
    values += 0.1 * deviation.cwiseProduct(dice.normal(n, 1));
  }
  [[nodiscard]] Smoother smoother() const { return {kernel, trend, deviation}; }
  [[nodiscard]] SmootherCase without(Eigen::Index m) const {
    SmootherCase less = *this;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      if (k != m) kept.push_back(k);
    }
    less.places = places(kept, Eigen::all);
    less.kernel = kernel(kept, kept);
    less.trend = trend(kept, Eigen::all);
    less.deviation = deviation(kept);
    less.values = values(kept);
    return less;
  }
};

double at_place(const SmoothFunction& function, const SmootherCase& data, const SmootherCase& of,
                Eigen::Index m) {
  const Eigen::MatrixXd kernel = bending_kernel(of.places.row(m), data.places);
  return (kernel * function.weights)(0) + of.trend.row(m).dot(function.trend);
}

TEST(Smoother, SolvesTheBorderedSystemOfTheSource) {
  const SmootherCase data;
  const auto n = data.values.size();
  const double lambda = 0.03;
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 3, n + 3);
  bordered.topLeftCorner(n, n) = data.kernel;
  bordered.diagonal().head(n) += lambda * data.deviation.cwiseAbs2();
  bordered.topRightCorner(n, 3) = data.trend;
  bordered.bottomLeftCorner(3, n) = data.trend.transpose();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 3);
  right.head(n) = data.values;
  const Eigen::VectorXd known = bordered.partialPivLu().solve(right);
  const auto found = data.smoother().fit(data.values, lambda);
  EXPECT_LT((found.weights - known.head(n)).norm(), 1e-10 * known.norm());
  EXPECT_LT((found.trend - known.tail(3)).norm(), 1e-10 * known.norm());
}

TEST(Smoother, LeavesOneOutAsARefitDoes) {
  const SmootherCase data;
  const auto smoother = data.smoother();
  for (const double lambda : {1e-4, 0.05, 20.0}) {
    const auto errors = smoother.left_out_errors(data.values, lambda);
    for (Eigen::Index m = 0; m < data.values.size(); ++m) {
      const auto less = data.without(m);
      const auto refit = less.smoother().fit(less.values, lambda);
      EXPECT_NEAR(errors(m), data.values(m) - at_place(refit, less, data, m), 1e-9) << m;
    }
    const Eigen::ArrayXd relative = errors.cwiseQuotient(data.deviation).array();
    const auto loo = smoother.criterion(data.values, SmoothingRule::leave_one_out, 1.0, lambda);
    EXPECT_NEAR(loo.value, relative.square().sum(), 1e-10 * loo.value);

    const Eigen::ArrayXd a = smoother.influence(lambda).array();
    const Eigen::ArrayXd weight = ((1.0 - a) / (1.0 - a.mean())).square();
    const auto gcv =
        smoother.criterion(data.values, SmoothingRule::generalised_cross_validation, 1.0, lambda);
    EXPECT_NEAR(gcv.value, (weight * relative.square()).sum(), 1e-10 * gcv.value);
  }
}

TEST(Smoother, HasTheInfluenceThatDifferencesShow) {
  const SmootherCase data;
  const auto smoother = data.smoother();
  const auto influence = smoother.influence(0.1);
  for (const Eigen::Index m : {0, 4, 12}) {
    Eigen::VectorXd moved = data.values;
    moved(m) += 1.0;  // linear: any step will do
    const double rise = at_place(smoother.fit(moved, 0.1), data, data, m) -
                        at_place(smoother.fit(data.values, 0.1), data, data, m);
    EXPECT_NEAR(influence(m), rise, 1e-10);
  }
}

// −2 ln L = ln|Σ| + ln|TᵀΣ⁻¹T| − ln|TᵀT| + yᵀPy + (n − p) ln 2π (Harville 1974).
double dense_reml(const SmootherCase& data, double lambda, double noise) {
  const Eigen::MatrixXd inverse = data.deviation.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd t = inverse * data.trend;
  const Eigen::VectorXd y = inverse * data.values;
  Eigen::MatrixXd sigma = inverse * data.kernel * inverse / lambda;
  sigma.diagonal().array() += 1.0;
  sigma *= noise * noise;
  const Eigen::MatrixXd solved = sigma.partialPivLu().solve(t);
  const Eigen::MatrixXd information = t.transpose() * solved;
  const Eigen::VectorXd best = information.ldlt().solve(solved.transpose() * y);
  const Eigen::VectorXd rest = y - t * best;
  const double square = rest.dot(sigma.partialPivLu().solve(rest));
  const auto count = static_cast<double>(y.size() - t.cols());
  return 0.5 *
         (std::log(std::abs(sigma.determinant())) + std::log(std::abs(information.determinant())) -
          std::log((t.transpose() * t).determinant()) + square +
          count * std::log(2.0 * std::numbers::pi));
}

TEST(Smoother, HasTheRestrictedLikelihoodOfTheDenseFormula) {
  const SmootherCase data;
  const auto smoother = data.smoother();
  for (const double lambda : {1e-3, 0.1, 10.0}) {
    const auto known =
        smoother.criterion(data.values, SmoothingRule::reml_known_noise, 0.2, lambda);
    EXPECT_NEAR(known.value, dense_reml(data, lambda, 0.2), 1e-8 * std::abs(known.value));
    // Profiled: the best over the noise.
    const auto profiled = smoother.criterion(data.values, SmoothingRule::reml, 1.0, lambda);
    double best = 1e300;
    for (double noise = 1e-3; noise < 100.0; noise *= 1.002) {
      best = std::min(
          best,
          smoother.criterion(data.values, SmoothingRule::reml_known_noise, noise, lambda).value);
    }
    EXPECT_LE(profiled.value, best + 1e-12);
    EXPECT_NEAR(profiled.value, best, 1e-4);
  }
}

constexpr SmoothingRule kSmootherRules[] = {SmoothingRule::reml_known_noise, SmoothingRule::reml,
                                            SmoothingRule::generalised_cross_validation,
                                            SmoothingRule::leave_one_out};

TEST(Smoother, HasTheSlopesThatDifferencesShow) {
  const SmootherCase data;
  const auto smoother = data.smoother();
  for (const auto rule : kSmootherRules) {
    for (const double lambda : {1e-3, 0.1, 10.0}) {
      constexpr double kStep = 1e-4;
      const auto at = [&](double factor) {
        return smoother.criterion(data.values, rule, 0.2, lambda * factor);
      };
      const double slope = (at(std::exp(kStep)).value - at(std::exp(-kStep)).value) / (2.0 * kStep);
      EXPECT_NEAR(at(1.0).slope, slope, 1e-5 * (1.0 + std::abs(slope))) << lambda;
    }
  }
}

TEST(Smoother, FindsTheLowestPointOfEachCriterion) {
  for (const unsigned seed : {5U, 6U, 7U, 8U}) {
    const SmootherCase data(13, seed);
    const auto smoother = data.smoother();
    for (const auto rule : kSmootherRules) {
      const auto found = smoother.chosen(data.values, rule, 0.2);
      const double value = smoother.criterion(data.values, rule, 0.2, found.lambda).value;
      for (double lambda = 1e-8; lambda < 1e8; lambda *= 1.1) {
        const double other = smoother.criterion(data.values, rule, 0.2, lambda).value;
        EXPECT_LE(value, other + 1e-6 * std::abs(other)) << seed << " " << lambda;
      }
    }
  }
}

TEST(Smoother, InterpolatesWithoutSmoothingAndIsFlatWithAllOfIt) {
  const SmootherCase data;
  const auto smoother = data.smoother();
  const auto through = smoother.fit(data.values, 1e-12);
  const auto flat = smoother.fit(data.values, std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd weight = data.deviation.cwiseAbs2().cwiseInverse().asDiagonal();
  const Eigen::VectorXd plane = (data.trend.transpose() * weight * data.trend)
                                    .ldlt()
                                    .solve(data.trend.transpose() * weight * data.values);
  EXPECT_EQ(flat.weights.norm(), 0.0);
  EXPECT_LT((flat.trend - plane).norm(), 1e-12);
  for (Eigen::Index m = 0; m < data.values.size(); ++m) {
    EXPECT_NEAR(at_place(through, data, data, m), data.values(m), 1e-9);
  }
}

// The bordered matrix again: Σ of the values, the free part's unknowns beside it.
TEST(Smoother, HasTheVarianceOfUniversalKriging) {
  const SmootherCase data;
  const auto n = data.values.size();
  const Smoothing smoothing{0.07, 0.3, 0.0, false};
  const double square = smoothing.noise * smoothing.noise;
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 3, n + 3);
  bordered.topLeftCorner(n, n) = square / smoothing.lambda * data.kernel;
  bordered.diagonal().head(n) += square * data.deviation.cwiseAbs2();
  bordered.topRightCorner(n, 3) = data.trend;
  bordered.bottomLeftCorner(3, n) = data.trend.transpose();
  const Eigen::MatrixXd places = Dice(9).normal(20, 2);
  const Eigen::MatrixXd kernel = bending_kernel(places, data.places);
  const Eigen::MatrixXd trend = plane_functions(places);
  const Eigen::MatrixXd variance =
      data.smoother().variance(kernel, Eigen::VectorXd::Zero(20), trend, {smoothing});
  for (Eigen::Index k = 0; k < 20; ++k) {
    Eigen::VectorXd right(n + 3);
    right << square / smoothing.lambda * kernel.row(k).transpose(), trend.row(k).transpose();
    const double known = -right.dot(bordered.partialPivLu().solve(right));
    EXPECT_NEAR(variance(k, 0), known, 1e-9 * std::abs(known));
  }
}

TEST(Smoother, TakesPlacesAtOnePointAsWeightedMean) {
  SmootherCase data(8, 3);
  data.places.row(7) = data.places.row(6);
  data.kernel = bending_kernel(data.places, data.places);
  data.trend = plane_functions(data.places);
  auto merged = data.without(7);
  const double a = std::pow(data.deviation(6), -2);
  const double b = std::pow(data.deviation(7), -2);
  merged.values(6) = (a * data.values(6) + b * data.values(7)) / (a + b);
  merged.deviation(6) = 1.0 / std::sqrt(a + b);
  const auto both = data.smoother().fit(data.values, 0.02);
  const auto one = merged.smoother().fit(merged.values, 0.02);
  for (Eigen::Index m = 0; m < 8; ++m) {
    EXPECT_NEAR(at_place(both, data, data, m), at_place(one, merged, data, m), 1e-9);
  }
  for (const auto rule : kSmootherRules) {
    const auto chosen = data.smoother().chosen(data.values, rule, 0.1);
    EXPECT_TRUE(std::isfinite(chosen.noise)) << static_cast<int>(rule);
  }
}

// A kernel may hold any amount of what is free anyway.
TEST(Smoother, DoesNotFeelTheFreePartOfItsKernel) {
  const SmootherCase data;
  const auto plain = data.smoother();
  const Eigen::MatrixXd much = data.kernel + 1e9 * data.trend * data.trend.transpose();
  const Smoother loaded(much, data.trend, data.deviation);
  const double lambda = 0.05;
  for (const auto rule : kSmootherRules) {
    const double value = plain.criterion(data.values, rule, 0.2, lambda).value;
    EXPECT_NEAR(loaded.criterion(data.values, rule, 0.2, lambda).value, value,
                1e-4 * std::abs(value));
  }
  const Eigen::MatrixXd rank_one = Eigen::MatrixXd::Constant(13, 13, 1e3);
  const Smoother flat(rank_one, Eigen::MatrixXd::Ones(13, 1), data.deviation);
  const auto chosen = flat.chosen(data.values, SmoothingRule::reml_known_noise, 0.2);
  EXPECT_TRUE(std::isinf(chosen.lambda));
}

// Four sensors in a row and one beside it: nothing foretells the fifth, and the rest of its error
// was a sum of 1e32 by rounding.
TEST(Smoother, LeavesOutNoPlaceThatTiltsThePlaneAlone) {
  SmootherCase data(5);
  data.places << -0.3, 0.0, -0.1, 0.0, 0.1, 0.0, 0.35, 0.0, 0.0, 0.4;
  data.kernel = bending_kernel(data.places, data.places);
  data.trend = plane_functions(data.places);
  data.values << 1.0, 0.1, -0.1, 1.3, 3.0;
  const auto smoother = data.smoother();
  const auto errors = smoother.left_out_errors(data.values, 0.05);
  EXPECT_TRUE(std::isnan(errors(4)));
  EXPECT_TRUE(errors.head(4).allFinite());
  const double sum = errors.head(4).cwiseQuotient(data.deviation.head(4)).squaredNorm();
  EXPECT_NEAR(smoother.criterion(data.values, SmoothingRule::leave_one_out, 0.1, 0.05).value, sum,
              1e-9 * sum);
  const auto chosen = smoother.chosen(data.values, SmoothingRule::leave_one_out, 0.1);
  auto other = data;
  other.values(4) += 10.0;  // tilts the plane and tells nothing else
  EXPECT_NEAR(
      smoother.chosen(other.values, SmoothingRule::leave_one_out, 0.1).lambda / chosen.lambda, 1.0,
      1e-6);
}

// Four places in the plane have one contrast. Cross-validation and a learned noise are constant in
// the smoothing, and the last bits chose it.
TEST(Smoother, OneContrastIsSmoothedByTheStatedNoise) {
  const SmootherCase data(4);
  const auto smoother = data.smoother();
  ASSERT_EQ(smoother.contrast_count(), 1);
  const auto stated = smoother.chosen(data.values, SmoothingRule::reml_known_noise, 0.2);
  for (const auto rule : kSmootherRules) {
    EXPECT_EQ(smoother.chosen(data.values, rule, 0.2).lambda, stated.lambda);
  }
}

TEST(Smoother, RefusesWhatCannotBeMeant) {
  const SmootherCase data;
  EXPECT_THROW(Smoother(data.kernel, data.trend.topRows(5), data.deviation), InvalidInput);
  EXPECT_THROW(Smoother(data.kernel, data.trend, -data.deviation), InvalidInput);
  Eigen::MatrixXd line = data.trend;
  line.col(2) = 2.0 * line.col(1);
  EXPECT_THROW(Smoother(data.kernel, line, data.deviation), InvalidInput);
  EXPECT_THROW(Smoother(-data.kernel, data.trend, data.deviation), NumericalFailure);
  EXPECT_THROW((void)data.smoother().fit(data.values.head(3), 1.0), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
