#include "priors/residual/random_coefficients.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "base/error.h"

namespace chladni::priors {
namespace {

struct CoefficientCase {
  Eigen::MatrixXd weighted;
  Eigen::VectorXd values, noise;
};

// Functions, values that they can show, uneven noise.
CoefficientCase random_case(Eigen::Index s, Eigen::Index k, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  CoefficientCase made{Eigen::MatrixXd(s, k), Eigen::VectorXd(s), Eigen::VectorXd(s)};
  for (double& x : made.weighted.reshaped()) x = 2.0 * uniform();
  Eigen::VectorXd b(k);
  for (double& x : b) x = 4.0 * uniform();
  for (Eigen::Index i = 0; i < s; ++i) {
    made.noise(i) = 0.05 + 0.1 * (uniform() + 0.5);
    made.values(i) = made.weighted.row(i).dot(b) + made.noise(i) * 2.0 * uniform();
  }
  return made;
}

Eigen::MatrixXd covariance(const CoefficientCase& one, double square) {
  Eigen::MatrixXd all = square * one.weighted * one.weighted.transpose();
  all.diagonal() += one.noise.cwiseAbs2();
  return all;
}

double textbook_evidence(const CoefficientCase& one, double square) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance(one, square));
  const double determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return -0.5 * (determinant + one.values.dot(factor.solve(one.values)) +
                 static_cast<double>(one.values.size()) * std::log(2.0 * std::numbers::pi));
}

class Sizes : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  CoefficientCase made = random_case(std::get<0>(GetParam()), std::get<1>(GetParam()), 5);
  RandomCoefficients shape{made.weighted, made.values, made.noise};
};

TEST_P(Sizes, EvidenceIsTheTextbooks) {
  EXPECT_NEAR(shape.log_evidence(), textbook_evidence(made, shape.amplitude_square()), 1e-8);
}

TEST_P(Sizes, MeanIsThePosteriors) {
  const auto mean = shape.posterior().mean;
  EXPECT_LT((shape.mean() - mean).norm(), 1e-8 * mean.norm());
}

TEST_P(Sizes, NoAmplitudeIsLikelier) {
  for (double ln = -8.0; ln < 8.0; ln += 0.01) {
    EXPECT_LE(textbook_evidence(made, shape.amplitude_square() * std::exp(ln)),
              shape.log_evidence() + 1e-9);
  }
}

TEST_P(Sizes, PosteriorIsTheTextbooks) {
  const double square = shape.amplitude_square();
  const Eigen::MatrixXd gain =
      square * made.weighted.transpose() * covariance(made, square).inverse();
  const auto known = shape.posterior();
  EXPECT_LT((known.mean - gain * made.values).norm(), 1e-8 * known.mean.norm());
  const Eigen::MatrixXd left =
      square * Eigen::MatrixXd::Identity(gain.rows(), gain.rows()) - square * gain * made.weighted;
  EXPECT_LT((known.root * known.root.transpose() - left).norm(), 1e-8 * square);
}

TEST_P(Sizes, SlopesAreDifferences) {
  const double step = 1e-5;
  const auto of_variance = shape.variance_slopes();
  for (Eigen::Index j = 0; j < made.weighted.cols(); ++j) {
    CoefficientCase up = made;
    CoefficientCase down = made;
    up.weighted.col(j) *= std::exp(0.5 * step);
    down.weighted.col(j) *= std::exp(-0.5 * step);
    const double slope = (textbook_evidence(up, shape.amplitude_square()) -
                          textbook_evidence(down, shape.amplitude_square())) /
                         (2.0 * step);
    EXPECT_NEAR(of_variance(j), slope, 1e-6 * (1.0 + std::abs(slope)));
  }
  const auto of_noise = shape.noise_slopes();
  for (Eigen::Index i = 0; i < made.noise.size(); ++i) {
    CoefficientCase up = made;
    CoefficientCase down = made;
    up.noise(i) *= std::exp(step);
    down.noise(i) *= std::exp(-step);
    const double slope = (textbook_evidence(up, shape.amplitude_square()) -
                          textbook_evidence(down, shape.amplitude_square())) /
                         (2.0 * step);
    EXPECT_NEAR(of_noise(i), slope, 1e-6 * (1.0 + std::abs(slope)));
  }
}

TEST_P(Sizes, LeftOutValuesAreThoseOfAFitWithoutThem) {
  const auto left = shape.left_out();
  const double square = shape.amplitude_square();
  const Eigen::MatrixXd all = covariance(made, square);
  const Eigen::Index s = made.values.size();
  double density = 0.0;
  for (Eigen::Index i = 0; i < s; ++i) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index j = 0; j < s; ++j) {
      if (j != i) others.push_back(j);
    }
    const Eigen::MatrixXd inverse = all(others, others).inverse();
    const Eigen::RowVectorXd cross = all(std::vector<Eigen::Index>{i}, others);
    const double mean = cross * inverse * made.values(others);
    const double variance = all(i, i) - cross * inverse * cross.transpose();
    const double z = (made.values(i) - mean) / std::sqrt(variance);
    EXPECT_NEAR(left.standardised(i), z, 1e-6 * (1.0 + std::abs(z)));
    density -= 0.5 * (z * z + std::log(2.0 * std::numbers::pi * variance));
  }
  EXPECT_NEAR(left.log_density, density, 1e-6 * (1.0 + std::abs(density)));
}

INSTANTIATE_TEST_SUITE_P(RandomCoefficients, Sizes,
                         testing::Values(std::tuple(5, 12), std::tuple(12, 12), std::tuple(30, 7)));

TEST(RandomCoefficients, SayThatNoiseAloneExplainsTheValues) {
  CoefficientCase made = random_case(40, 5, 7);
  made.values.setZero();
  EXPECT_TRUE(RandomCoefficients(made.weighted, made.values, made.noise).vanishes());
}

TEST(RandomCoefficients, RefuseSizesThatDoNotFitAndNoNoise) {
  const CoefficientCase made = random_case(6, 4, 1);
  EXPECT_THROW(RandomCoefficients(made.weighted, made.values.head(5), made.noise), InvalidInput);
  EXPECT_THROW(RandomCoefficients(made.weighted, made.values, 0.0 * made.noise), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
