#include "identification/validation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "base/finite.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr Index kFewestLines = 8;
constexpr double kOnceInTwenty = 1.96;

// First lines of the bands, and the number of lines.
std::vector<Index> borders(const Eigen::VectorXd& line_hz, const Eigen::VectorXd& mode_hz) {
  const Index lines = line_hz.size();
  const auto line_at = [&](double hz) {
    return std::lower_bound(line_hz.data(), line_hz.data() + lines, hz) - line_hz.data();
  };
  std::vector<Index> border{0};
  for (Index m = 0; m + 1 < mode_hz.size(); ++m) {
    if (line_at(mode_hz(m + 1)) - line_at(mode_hz(m)) < kFewestLines) continue;
    const Index line = line_at(std::sqrt(mode_hz(m) * mode_hz(m + 1)));
    const bool is_long = line - border.back() >= kFewestLines && lines - line >= kFewestLines;
    if (is_long) border.push_back(line);
  }
  border.push_back(lines);
  return border;
}

BandResidual band_residual(const FitData& data, const Eigen::MatrixXcd& error, Index first,
                           Index count) {
  const FitData part{.outputs = data.outputs,
                     .inputs = data.inputs,
                     .frequency_hz = data.frequency_hz.segment(first, count),
                     .value = data.value.middleRows(first, count),
                     .weight = data.weight.middleRows(first, count),
                     .noise_known = data.noise_known,
                     .noise_stated = data.noise_stated,
                     .freedom_known = data.freedom_known,
                     .noise_freedom = data.noise_freedom,
                     .shared_lines = std::min(data.shared_lines, static_cast<double>(count)),
                     .weights_are_deviations = data.weights_are_deviations};
  const auto weight = part.weight.array();
  const Eigen::ArrayXXcd e = error.middleRows(first, count).array();
  const Eigen::ArrayXXcd white = e * weight;
  const auto numbers = static_cast<double>((weight > 0.0).count());
  BandResidual band{part.frequency_hz(0), part.frequency_hz(count - 1), count};
  band.relative_error = e.matrix().norm() / part.value.norm();
  band.relative_noise = noise_of(part) / part.value.norm();
  const double power = white.abs2().sum();
  const auto expected = expected_cost(part, 0);
  band.level = power / expected.mean;
  band.level_deviation = expected.deviation / expected.mean;
  const double along =
      (white.topRows(count - 1).conjugate() * white.bottomRows(count - 1)).real().sum();
  band.correlation = power > 0.0 ? along / power : 0.0;
  band.correlation_limit = kOnceInTwenty / std::sqrt(2.0 * numbers);
  return band;
}

}  // namespace

Validation validation(const FitData& data, const Eigen::MatrixXcd& fitted,
                      const Eigen::VectorXd& frequency_hz) {
  const Eigen::ArrayXXd measured = (data.weight.array() > 0.0).cast<double>();
  const Eigen::MatrixXcd error = ((data.value - fitted).array() * measured).matrix();
  Validation result;
  result.fit_percent_of.resize(data.outputs, data.inputs);
  double about_mean = 0.0;
  for (Index c = 0; c < data.response_count(); ++c) {
    const double count = measured.col(c).sum();
    auto& percent = result.fit_percent_of.reshaped()(c);
    percent = kUnknown;
    if (count == 0.0) continue;
    const std::complex<double> mean = (data.value.col(c).array() * measured.col(c)).sum() / count;
    const double spread =
        ((data.value.col(c).array() - mean) * measured.col(c)).matrix().squaredNorm();
    about_mean += spread;
    percent = 100.0 * (1.0 - error.col(c).norm() / std::sqrt(spread));
  }
  result.fit_percent = 100.0 * (1.0 - error.norm() / std::sqrt(about_mean));
  result.whole = band_residual(data, error, 0, data.line_count());
  const auto border = borders(data.frequency_hz, frequency_hz);
  for (std::size_t b = 0; b + 1 < border.size(); ++b) {
    result.bands.push_back(band_residual(data, error, border[b], border[b + 1] - border[b]));
  }
  return result;
}

Eigen::MatrixXd mode_indicator(const FitData& data) {
  const Index count = std::min(data.outputs, data.inputs);
  Eigen::MatrixXd values(data.line_count(), count);
  for (Index k = 0; k < data.line_count(); ++k) {
    if (data.weight.row(k).minCoeff() <= 0.0) {
      values.row(k).setConstant(kUnknown);
      continue;
    }
    const Eigen::MatrixXcd g = data.value.row(k).reshaped(data.outputs, data.inputs);
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(finite(g, "responses"));
    values.row(k) = svd.singularValues().transpose();
  }
  return values;
}

}  // namespace chladni::identification
