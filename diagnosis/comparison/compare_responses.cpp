// Comparison of simulated responses with measured ones.
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/error.h"
#include "diagnosis/comparison/compared_responses.h"

namespace chladni::diagnosis {
namespace {

using Complex = std::complex<double>;

double frac(const ComparedResponse& one) {
  const double sizes = one.measured.squaredNorm() * one.simulated.squaredNorm();
  return sizes > 0.0 ? std::norm(one.simulated.dot(one.measured)) / sizes : 0.0;
}

// Errors over their deviation, on all lines with positive variance; empty if there are none.
Eigen::VectorXcd over_deviation(const ComparedResponse& one) {
  std::vector<Complex> values;
  for (Eigen::Index k = 0; k < one.variance.size(); ++k) {
    if (!(one.variance(k) > 0.0)) continue;
    values.push_back((one.measured(k) - one.simulated(k)) / std::sqrt(one.variance(k)));
  }
  return Eigen::Map<const Eigen::VectorXcd>(values.data(),
                                            static_cast<Eigen::Index>(values.size()));
}

double chi_square(const ComparedResponse& one) {
  const auto left = over_deviation(one);
  return left.size() > 0 ? left.squaredNorm() / static_cast<double>(left.size()) : kNotMeasured;
}

double lag_one(const ComparedResponse& one) {
  const auto left = over_deviation(one);
  const auto n = left.size();
  if (n < 2) return kNotMeasured;
  const double size = left.squaredNorm();
  return size > 0.0 ? left.head(n - 1).dot(left.tail(n - 1)).real() / size : 0.0;
}

void set_errors(const ComparedResponses& of, ResponseComparison& result) {
  double wrong = 0.0;
  double size = 0.0;
  double noise = 0.0;
  for (const auto& one : of.all) {
    wrong += (one.measured - one.simulated).squaredNorm();
    size += one.measured.squaredNorm();
    noise += one.variance.sum();
  }
  const bool stated = std::ranges::any_of(of.all, [](const ComparedResponse& one) {
    return one.variance.size() > 0;  // one that was not measured has none
  });
  result.overall_error = std::sqrt(wrong / size);
  result.overall_noise = stated ? std::sqrt(noise / size) : kNotMeasured;
  result.error = per_response(of, [](const ComparedResponse& one) {
    return (one.measured - one.simulated).norm() / one.measured.norm();
  });
  result.noise = per_response(of, [&](const ComparedResponse& one) {
    return stated ? std::sqrt(one.variance.sum()) / one.measured.norm() : kNotMeasured;
  });
  result.frac = per_response(of, frac);
  result.chi_square = per_response(of, chi_square);
  result.lag_one = per_response(of, lag_one);
}

// Squares of the errors and of the measured values, responses × bands.
struct BandSums {
  Eigen::MatrixXd wrong, size;
};

BandSums band_sums(const ComparedResponses& of, const Eigen::VectorXd& edges) {
  const auto n = static_cast<Eigen::Index>(of.all.size());
  const Eigen::Index bands = edges.size() - 1;
  BandSums sums{Eigen::MatrixXd::Zero(n, bands), Eigen::MatrixXd::Zero(n, bands)};
  for (Eigen::Index e = 0; e < n; ++e) {
    const auto& one = of.all[static_cast<std::size_t>(e)];
    for (Eigen::Index k = 0; k < one.count(); ++k) {
      const auto above = std::upper_bound(edges.begin(), edges.end(), one.frequency_hz(k));
      const auto band = std::clamp<Eigen::Index>(above - edges.begin() - 1, 0, bands - 1);
      sums.wrong(e, band) += std::norm(one.measured(k) - one.simulated(k));
      sums.size(e, band) += std::norm(one.measured(k));
    }
  }
  return sums;
}

void set_bands(const ComparedResponses& of, int bands, ResponseComparison& result) {
  const auto& lines = result.frequency_hz;
  const double low = lines(0) > 0.0 || lines.size() == 1 ? lines(0) : lines(1);
  const double ratio = std::log(lines(lines.size() - 1) / low);
  result.band_edges_hz.resize(bands + 1);
  for (int b = 0; b <= bands; ++b) result.band_edges_hz(b) = low * std::exp(b * ratio / bands);
  const auto sums = band_sums(of, result.band_edges_hz);
  const auto relative = [](const Eigen::ArrayXXd& wrong, const Eigen::ArrayXXd& size) {
    return Eigen::MatrixXd((wrong / size).sqrt());  // 0/0: no line in this band
  };
  result.band_error = relative(sums.wrong.colwise().sum().transpose().array(),
                               sums.size.colwise().sum().transpose().array());
  Eigen::MatrixXd wrong_out = Eigen::MatrixXd::Zero(of.outputs, bands);
  Eigen::MatrixXd size_out = wrong_out;
  Eigen::MatrixXd wrong_in = Eigen::MatrixXd::Zero(of.inputs, bands);
  Eigen::MatrixXd size_in = wrong_in;
  for (Eigen::Index e = 0; e < sums.wrong.rows(); ++e) {
    wrong_out.row(e % of.outputs) += sums.wrong.row(e);
    size_out.row(e % of.outputs) += sums.size.row(e);
    wrong_in.row(e / of.outputs) += sums.wrong.row(e);
    size_in.row(e / of.outputs) += sums.size.row(e);
  }
  result.output_band_error = relative(wrong_out.array(), size_out.array());
  result.input_band_error = relative(wrong_in.array(), size_in.array());
}

void set_lines(const modal::FrfSet& measured, const std::vector<Eigen::MatrixXcd>& simulated,
               ResponseComparison& result) {
  const auto n = result.frequency_hz.size();
  result.shape_alike = Eigen::VectorXd::Constant(n, kNotMeasured);
  result.size_alike = Eigen::VectorXd::Constant(n, kNotMeasured);
  Eigen::Index line = 0;
  for (Eigen::Index k = 0; k < measured.line_count() && line < n; ++k) {
    if (measured.frequency_hz(k) != result.frequency_hz(line)) continue;
    Complex between = 0.0;
    double a = 0.0;
    double b = 0.0;
    const auto& value = measured.value[static_cast<std::size_t>(k)];
    for (Eigen::Index e = 0; e < value.size(); ++e) {
      const Complex g = value.reshaped()(e);
      if (!std::isfinite(g.real()) || !std::isfinite(g.imag())) continue;
      const Complex s = simulated[static_cast<std::size_t>(k)].reshaped()(e);
      between += std::conj(s) * g;
      a += std::norm(g);
      b += std::norm(s);
    }
    if (a > 0.0 && b > 0.0) {
      result.shape_alike(line) = std::norm(between) / (a * b);
      result.size_alike(line) = 2.0 * std::abs(between) / (a + b);
    }
    ++line;
  }
}

}  // namespace

ResponseComparison compared(const modal::FrfSet& measured,
                            const std::vector<Eigen::MatrixXcd>& simulated,
                            const ComparisonOptions& options) {
  modal::check(measured);
  require(simulated.size() == measured.value.size(),
          "comparison: measured and simulated lines differ in number");
  for (const auto& line : simulated) {
    require(line.rows() == measured.output_count() && line.cols() == measured.input_count(),
            "comparison: measured and simulated responses differ in number");
  }
  require(options.bands > 0, "comparison: at least one band is expected");
  const ComparedResponses of = responses_of(measured, simulated, options);
  ResponseComparison result;
  result.outputs = modal::names_of(measured.outputs);
  result.inputs = modal::names_of(measured.inputs);
  std::vector<double> lines;
  for (const double f : measured.frequency_hz) {
    if (in_band(f, options)) lines.push_back(f);
  }
  result.frequency_hz =
      Eigen::Map<const Eigen::VectorXd>(lines.data(), static_cast<Eigen::Index>(lines.size()));
  set_errors(of, result);
  set_bands(of, options.bands, result);
  set_lines(measured, simulated, result);
  set_gains(of, result);
  result.output_alike = channels_alike(of, true);
  result.input_alike = channels_alike(of, false);
  set_signs(of, result);
  return result;
}

}  // namespace chladni::diagnosis
