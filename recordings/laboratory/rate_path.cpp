#include "recordings/laboratory/rate_path.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/search.h"
#include "base/turn.h"

namespace chladni::recordings {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr auto kReach = static_cast<double>(kRateAhead);
// Four terms, side lobes of -92 dB (Harris 1978, table 1).
constexpr std::array<double, 4> kWindow = {0.35875, 0.48829, 0.14128, 0.01168};

// The window and its slope at s samples from the middle.
std::array<double, 2> window(double s) {
  double value = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < kWindow.size(); ++i) {
    const double turns = kPi * static_cast<double>(i) / kReach;
    value += kWindow[i] * std::cos(turns * s);
    slope -= kWindow[i] * turns * std::sin(turns * s);
  }
  return {value, slope};
}

// sin πs / πs and its slope.
std::array<double, 2> sinc(double s) {
  const double x = kPi * s;
  if (std::abs(x) < 1e-4) return {1.0 - x * x / 6.0, -kPi * x / 3.0};
  const double value = std::sin(x) / x;
  return {value, (std::cos(x) - value) / s};
}

constexpr std::size_t kMoments = 5;  // the last one for a bend of the fourth derivative
using Moments = Eigen::Array<double, kMoments, 1>;

// The filter's response to an impulse of area 1, s samples after it.
struct Answer {
  double slope = 0.0;    ///< of the response
  double impulse = 0.0;  ///< the response itself
  double step = 0.0;     ///< the response to a step
  /// What the filter changes of s, s²/2, s³/6, ..., which begin at s = 0.
  std::array<double, kMoments - 1> bends = {};
};

double impulse_at(double s) { return std::abs(s) < kReach ? sinc(s)[0] * window(s)[0] : 0.0; }

double slope_at(double s) {
  if (std::abs(s) >= kReach) return 0.0;
  return sinc(s)[1] * window(s)[0] + sinc(s)[0] * window(s)[1];
}

// ∫ tⁿ k(t) dt for n = 0, 1, ... over a sample or less.
Moments moments(double from, double to) {
  Moments all;
  for (std::size_t n = 0; n < kMoments; ++n) {
    const auto weighted = [n](double t) { return std::pow(t, n) * impulse_at(t); };
    all(static_cast<Eigen::Index>(n)) = integral_of(weighted, from, to);
  }
  return all;
}

// ∫ (s − t)ⁿ / n! k(t) dt by the moments of k.
double iterated(double s, std::size_t n, const Moments& moment) {
  double sum = 0.0;
  double term = 1.0;  // of the binomial: n over i
  for (std::size_t i = 0; i <= n; ++i) {
    sum += term * std::pow(s, n - i) * moment(static_cast<Eigen::Index>(i));
    term *= -static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return sum / std::tgamma(static_cast<double>(n) + 1.0);
}

Moments all_moments() {
  Moments sum = Moments::Zero();
  for (double s = -kReach; s < kReach; s += 1.0) sum += moments(s, s + 1.0);
  return sum;
}

// The answers at `first`, `first` + 1, ...; `first` lies before the filter's reach. Far behind an
// impulse the filter changes nothing: its moments beyond the first, -7e-5 and less, are no more
// than its ripple, and would drift.
std::vector<Answer> answers(double first, Eigen::Index count) {
  const auto all = all_moments();
  std::vector<Answer> result;
  Moments passed = Moments::Zero();
  double at = -kReach;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double s = first + static_cast<double>(i);
    const double to = std::clamp(s, -kReach, kReach);
    passed += moments(at, to);
    at = to;
    Answer one{slope_at(s), impulse_at(s), passed(0) / all(0), {}};
    for (std::size_t n = 1; n < kMoments; ++n) {
      one.bends[n - 1] = iterated(s, n, passed) - (s > 0.0 ? iterated(s, n, all) : 0.0);
    }
    result.push_back(one);
  }
  return result;
}

// C Aᵐ B Tᵐ⁺¹ of the states, p×q each; 0 in rows of displacements.
using Bends = std::array<Eigen::MatrixXd, kMoments - 1>;

Bends bends_of(const Plant& plant, double time) {
  Bends bends;
  bends.fill(Eigen::MatrixXd::Zero(plant.output_count(), plant.input_count()));
  for (const auto& block : plant.blocks) {
    const double radius = block.a.eigenvalues().cwiseAbs().maxCoeff();
    const std::size_t count = radius * time < 0.25 * kTwoPi ? bends.size() : 1;
    Eigen::MatrixXd from = time * block.b;
    for (std::size_t m = 0; m < count; ++m) {
      bends[m] += block.c * from;
      from = time * block.a * from;
    }
  }
  const auto& path = *plant.rates;
  for (Eigen::Index i = 0; i < plant.output_count(); ++i) {
    if (!path.is_displacement[static_cast<std::size_t>(i)]) continue;
    for (auto& bend : bends) bend.row(i).setZero();
  }
  return bends;
}

// What the outputs take from a force that is held from `begin` to `end`: q×p.
Eigen::MatrixXd taken(const RatePath& path, const Bends& bends, const Answer& begin,
                      const Answer& end, double time) {
  Eigen::MatrixXd sum = (begin.step - end.step) * path.force +
                        (begin.impulse - end.impulse) / time * path.rate +
                        (begin.slope - end.slope) / (time * time) * path.second;
  for (std::size_t m = 0; m < bends.size(); ++m) sum += (begin.bends[m] - end.bends[m]) * bends[m];
  return sum.transpose();
}

}  // namespace

Eigen::MatrixXd along_rate_path(const Plant& plant, const SampledDelay& delay, double sample_time_s,
                                const Eigen::MatrixXd& force) {
  // Lags from -kRateAhead on. A force begins to act at its sample, after the delay, and ends one
  // sample later.
  const Eigen::Index lags = 2 * kRateAhead + 2;
  const auto answer = answers(-kReach - 1.0 - delay.fraction, lags + 1);
  const auto bends = bends_of(plant, sample_time_s);
  const auto rows = force.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows, plant.output_count());
  for (Eigen::Index l = 0; l < lags; ++l) {
    const auto matrix = taken(*plant.rates, bends, answer[static_cast<std::size_t>(l + 1)],
                              answer[static_cast<std::size_t>(l)], sample_time_s);
    const Eigen::Index by = delay.whole + l - kRateAhead;  // output n takes force n - by
    const Eigen::Index from = std::clamp<Eigen::Index>(by, 0, rows);
    const Eigen::Index to = std::clamp<Eigen::Index>(rows + by, from, rows);
    result.middleRows(from, to - from) += force.middleRows(from - by, to - from) * matrix;
    if (to < rows) result.bottomRows(rows - to).rowwise() += force.row(rows - 1) * matrix;
  }
  return result;
}

}  // namespace chladni::recordings
