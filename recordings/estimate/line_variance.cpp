#include "recordings/estimate/line_variance.h"

#include <algorithm>
#include <cmath>

#include "recordings/constants.h"

namespace chladni::recordings {
namespace {

// Nine shares of noise that does not grow, from half to 1e-4 of the mean.
constexpr int kShares = 9;
constexpr double kLeastShare = 1e-4;
constexpr double kAlike = 2.0;  // |G|² of lines that cannot tell

double share_that_stays(int step) {
  return 0.5 * std::pow(2.0 * kLeastShare, static_cast<double>(step) / (kShares - 1));
}

}  // namespace

double averaged_variance(const Eigen::Ref<const Eigen::VectorXd>& sample,
                         const Eigen::Ref<const Eigen::VectorXd>& power, Eigen::Index at,
                         double freedom) {
  const double mean = sample.mean();
  if (power.maxCoeff() <= kAlike * power.minCoeff() || !(mean > 0.0)) return mean;
  const auto n = static_cast<double>(sample.size());
  const Eigen::ArrayXd relative = power.array() / power.mean();
  constexpr double kGrows = Constants::growth_chance;
  Eigen::Array<double, 1 + kShares, 1> evidence;  // logarithms; the last: it does not grow
  Eigen::Array<double, 1 + kShares, 1> variance;
  evidence(kShares) = std::log((1.0 - kGrows) / kGrows * kShares) - freedom * n * std::log(mean);
  variance(kShares) = mean;
  for (int step = 0; step < kShares; ++step) {
    const double stays = share_that_stays(step);
    const Eigen::ArrayXd form = stays + (1.0 - stays) * relative;
    const double level = (sample.array() / form).mean();
    evidence(step) = -freedom * (form.log().sum() + n * std::log(level));
    variance(step) = level * form(at);
  }
  const Eigen::Array<double, 1 + kShares, 1> weight = (evidence - evidence.maxCoeff()).exp();
  return (weight * variance).sum() / weight.sum();
}

Eigen::VectorXd averaged_variances(const Eigen::Ref<const Eigen::VectorXd>& sample,
                                   const Eigen::Ref<const Eigen::VectorXd>& power,
                                   Eigen::Index half, double freedom) {
  if (half <= 0) return sample;
  Eigen::VectorXd result(sample.size());
  for (Eigen::Index k = 0; k < sample.size(); ++k) {
    const auto first = std::max<Eigen::Index>(0, k - half);
    const auto count = std::min(sample.size() - 1, k + half) - first + 1;
    result(k) = averaged_variance(sample.segment(first, count), power.segment(first, count),
                                  k - first, freedom);
  }
  return result;
}

std::vector<Eigen::MatrixXd> averaged_variances(const std::vector<Eigen::MatrixXd>& sample,
                                                const std::vector<Eigen::MatrixXcd>& value,
                                                Eigen::Index half, double freedom) {
  if (half <= 0 || sample.empty()) return sample;
  auto result = sample;
  const auto lines = static_cast<Eigen::Index>(sample.size());
  Eigen::VectorXd variances(lines);
  Eigen::VectorXd powers(lines);
  for (Eigen::Index e = 0; e < sample.front().size(); ++e) {
    for (Eigen::Index k = 0; k < lines; ++k) {
      variances(k) = sample[static_cast<std::size_t>(k)].reshaped()(e);
      powers(k) = std::norm(value[static_cast<std::size_t>(k)].reshaped()(e));
    }
    const auto averaged = averaged_variances(variances, powers, half, freedom);
    for (Eigen::Index k = 0; k < lines; ++k) {
      result[static_cast<std::size_t>(k)].reshaped()(e) = averaged(k);
    }
  }
  return result;
}

}  // namespace chladni::recordings
