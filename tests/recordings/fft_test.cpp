#include "recordings/fft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/draw.h"
#include "base/error.h"

namespace chladni::recordings {
namespace {

Eigen::MatrixXd noise(Eigen::Index samples, Eigen::Index columns) {
  Draw draw(4);
  Eigen::MatrixXd result(samples, columns);
  for (double& x : result.reshaped()) x = draw.normal();
  return result;
}

TEST(Fourier, InvertsForEvenOddAndPrimeLengths) {
  for (const Eigen::Index n : {1, 2, 3, 8, 97, 360}) {
    const auto x = noise(n, 3);
    EXPECT_LT((inverse_fourier(fourier(x), n) - x).norm(), 1e-13 * x.norm()) << n;
  }
}

TEST(Fourier, KeepsThePowerOfParseval) {
  for (const Eigen::Index n : {16, 17}) {
    const auto x = noise(n, 1);
    const auto lines = fourier(x);
    double power = 0.0;
    for (Eigen::Index k = 0; k < lines.rows(); ++k) {
      const bool alone = k == 0 || 2 * k == n;
      power += (alone ? 1.0 : 2.0) * std::norm(lines(k, 0));
    }
    EXPECT_NEAR(power / static_cast<double>(n), x.squaredNorm(), 1e-12 * x.squaredNorm());
  }
}

TEST(Fourier, IsTheSumItSays) {
  const auto x = noise(12, 1);
  const auto lines = fourier(x);
  for (Eigen::Index k = 0; k <= 6; ++k) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index n = 0; n < 12; ++n) {
      sum += x(n, 0) * std::polar(1.0, -2.0 * std::numbers::pi * double(k * n) / 12.0);
    }
    EXPECT_LT(std::abs(lines(k, 0) - sum), 1e-13);
  }
}

TEST(Fourier, RefusesNothingAndLinesOfAnotherLength) {
  EXPECT_THROW((void)fourier(Eigen::MatrixXd(0, 1)), InvalidInput);
  EXPECT_THROW((void)inverse_fourier(Eigen::MatrixXcd(4, 1), 8), InvalidInput);
}

}  // namespace
}  // namespace chladni::recordings
