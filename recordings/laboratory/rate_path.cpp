#include "recordings/laboratory/rate_path.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace chladni::recordings {
namespace {

// Central differences of eighth order (Fornberg 1988, table 1): weights of the samples 0 to 4 away.
constexpr std::array<double, 5> kFirst = {0.0, 4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
constexpr std::array<double, 5> kSecond = {-205.0 / 72.0, 8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0,
                                           -1.0 / 560.0};
constexpr std::array<double, 2> kThree = {-2.0, 1.0};  // of second order

// Σ w_i (s[n + i] ± s[n − i]) of every row n that has all its neighbours.
template <std::size_t Count>
Eigen::MatrixXd difference(const Eigen::MatrixXd& samples, const std::array<double, Count>& weight,
                           double sign) {
  constexpr auto reach = static_cast<Eigen::Index>(Count) - 1;
  const auto rows = samples.rows() - 2 * reach;
  Eigen::MatrixXd result = weight[0] * samples.middleRows(reach, rows);
  for (Eigen::Index i = 1; i <= reach; ++i) {
    result += weight[static_cast<std::size_t>(i)] *
              (samples.middleRows(reach + i, rows) + sign * samples.middleRows(reach - i, rows));
  }
  return result;
}

// Held forces from kRateAhead samples before the record to as many after it, delayed. Their second
// moment around the delay is that of one held sample, T²/12: the magnitude is then sin x / x.
Eigen::MatrixXd felt(const SampledDelay& delay, const Eigen::MatrixXd& force) {
  const auto& w = delay.weight;
  const auto rows = force.rows() + 2 * kRateAhead + 2;  // one more at each end for the moment
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(rows, force.cols());
  for (Eigen::Index n = 0; n < rows; ++n) {
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      const auto from = std::min(n - kRateAhead - 1 - delay.whole - i, force.rows() - 1);
      if (from >= 0) mean.row(n) += w(i) * force.row(from);
    }
  }
  const double middle = w(1) + 2.0 * w(2);
  const double spread = w(1) + 4.0 * w(2) - middle * middle;
  return mean.middleRows(1, rows - 2) - 0.5 * (spread - 1.0 / 12.0) * difference(mean, kThree, 1.0);
}

}  // namespace

Eigen::MatrixXd along_rate_path(const RatePath& path, const SampledDelay& delay,
                                double sample_time_s, const Eigen::MatrixXd& force) {
  constexpr Eigen::Index beside = kRateAhead - 4;  // rows that no difference needs
  const auto u = felt(delay, force);
  const Eigen::MatrixXd inner = u.middleRows(beside, u.rows() - 2 * beside);
  // A velocity kinks where a held force u jumps; its slope changes by c u there. Aliasing makes its
  // samples x² / sin² x of what the instrument records, x = ωT/2. The excess, −jω T²/12 of c u to
  // first order, is added back; where the jumps lie a fraction f of T beside samples, f (1 − f)
  // T²/2 less.
  const double f = delay.fraction;
  const double kink = sample_time_s * sample_time_s * (1.0 / 12.0 - 0.5 * f * (1.0 - f));
  Eigen::MatrixXd result =
      u.middleRows(kRateAhead, force.rows()) * path.force.transpose() +
      difference(inner, kFirst, -1.0) * (path.rate + kink * path.kink).transpose() / sample_time_s;
  result +=
      difference(inner, kSecond, 1.0) * path.second.transpose() / (sample_time_s * sample_time_s);
  return result;
}

}  // namespace chladni::recordings
