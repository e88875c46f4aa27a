#include "recordings/estimate/local_transient.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;

constexpr Index kNeighbours = 16;  // lines between those of the period that a fit uses
constexpr Index kDegree = 2;
constexpr Index kFreedom = kNeighbours - kDegree - 1;
constexpr double kWorthAPole = 0.5;  // of the variance that the polynomial leaves

/// Lines around one line of the period.
struct Window {
  std::vector<Index> lines;  // kNeighbours, of the transform of all periods
  Eigen::VectorXd offset;    // from that line, scaled to 1
  Eigen::MatrixXd powers;    // kNeighbours×(kDegree + 1)
  Eigen::MatrixXd fit;       // (kDegree + 1)×kNeighbours: least squares
  Eigen::MatrixXd rest;      // kFreedom×kNeighbours: orthonormal, across the polynomial
  double leverage = 0.0;     // variance of the polynomial at 0, of that of one line
};

Window window_at(Index line, Index periods, Index last) {
  Window window;
  for (Index step = 1; std::ssize(window.lines) < kNeighbours && step <= last; ++step) {
    for (const Index at : {line - step, line + step}) {
      if (at < 1 || at >= last || at % periods == 0) continue;
      if (std::ssize(window.lines) < kNeighbours) window.lines.push_back(at);
    }
  }
  require(std::ssize(window.lines) == kNeighbours,
          "transient: too few lines between those of the period; expected two periods or more of "
          "20 samples or more");
  window.offset.resize(kNeighbours);
  for (Index i = 0; i < kNeighbours; ++i) {
    window.offset(i) = static_cast<double>(window.lines[static_cast<std::size_t>(i)] - line);
  }
  window.offset /= window.offset.cwiseAbs().maxCoeff();
  window.powers.resize(kNeighbours, kDegree + 1);
  window.powers.col(0).setOnes();
  for (Index d = 1; d <= kDegree; ++d) {
    window.powers.col(d) = window.powers.col(d - 1).cwiseProduct(window.offset);
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(window.powers);
  window.fit = qr.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(kNeighbours, kNeighbours)));
  const Eigen::MatrixXd q = qr.householderQ();
  window.rest = q.rightCols(kFreedom).transpose();
  window.leverage = window.fit.row(0).squaredNorm();
  return window;
}

struct LocalFit {
  std::complex<double> transient;
  Eigen::VectorXcd left;  // kNeighbours
};

LocalFit polynomial(const Window& window, const Eigen::VectorXcd& values) {
  const Eigen::VectorXcd coefficient = window.fit * values;
  return {coefficient(0), values - window.powers * coefficient};
}

// b(x) / (1 + a x), from b − a x Y = Y.
LocalFit rational(const Window& window, const Eigen::VectorXcd& values) {
  Eigen::MatrixXcd system(kNeighbours, kDegree + 2);
  system.leftCols(kDegree + 1) = window.powers.cast<std::complex<double>>();
  system.col(kDegree + 1) = -window.offset.cast<std::complex<double>>().cwiseProduct(values);
  const Eigen::VectorXcd found = system.colPivHouseholderQr().solve(values);
  const Eigen::ArrayXcd below =
      1.0 + found(kDegree + 1) * window.offset.cast<std::complex<double>>().array();
  const Eigen::ArrayXcd above = (window.powers * found.head(kDegree + 1)).array();
  return {found(0), values - (above / below).matrix()};
}

LocalFit best(const Window& window, const Eigen::VectorXcd& values) {
  auto plain = polynomial(window, values);
  const double variance = plain.left.squaredNorm() / static_cast<double>(kFreedom);
  if (variance == 0.0) return plain;
  auto with_pole = rational(window, values);
  const double other = with_pole.left.squaredNorm() / static_cast<double>(kFreedom - 1);
  return std::isfinite(other) && other < kWorthAPole * variance ? with_pole : plain;
}

// (n + 1)×n: orthonormal columns across the mean (Helmert).
Eigen::MatrixXd helmert(Index n) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + 1, n);
  for (Index j = 0; j < n; ++j) {
    const auto count = static_cast<double>(j + 1);
    matrix.col(j).head(j + 1).setConstant(1.0 / std::sqrt(count * (count + 1.0)));
    matrix(j + 1, j) = -std::sqrt(count / (count + 1.0));
  }
  return matrix;
}

// The spectra of one side of a record: [pseudo-period] K×channels.
std::vector<Eigen::MatrixXcd> cleaned(const Eigen::MatrixXd& samples,
                                      const std::vector<Window>& windows,
                                      const std::vector<Index>& line, Index periods) {
  const auto count = static_cast<Index>(line.size());
  static const Eigen::MatrixXd spread = helmert(kFreedom);
  std::vector<Eigen::MatrixXcd> result(static_cast<std::size_t>(kFreedom + 1),
                                       Eigen::MatrixXcd(count, samples.cols()));
  if (samples.cols() == 0) return result;
  const Eigen::MatrixXcd all = fourier(samples);
  const auto of_all = static_cast<double>(periods);
  for (Index k = 0; k < count; ++k) {
    const auto& window = windows[static_cast<std::size_t>(k)];
    // Σ|Δ|² / (P'(P' − 1)) is then the variance of the mean.
    const double scale =
        std::sqrt(static_cast<double>(kFreedom + 1) * (1.0 + window.leverage)) / of_all;
    for (Index c = 0; c < samples.cols(); ++c) {
      const Eigen::VectorXcd around = all(window.lines, c);
      const auto fit = best(window, around);
      const auto mean =
          (all(line[static_cast<std::size_t>(k)] * periods, c) - fit.transient) / of_all;
      const Eigen::VectorXcd deviation = scale * (spread * (window.rest * fit.left));
      for (Index p = 0; p <= kFreedom; ++p) {
        result[static_cast<std::size_t>(p)](k, c) = mean + deviation(p);
      }
    }
  }
  return result;
}

}  // namespace

Spectra without_start(const TimeData& data, double low_hz, double high_hz) {
  auto result = spectra(data, low_hz, high_hz);
  result.records.clear();
  Index before = 0;
  std::vector<Window> windows;
  for (const auto& record : data.records) {
    const auto samples = record.outputs.rows();
    const auto periods = samples / data.period;
    require(periods >= 2,
            "transient: a record of one period; expected two or more, or transient = \"drop\"");
    if (periods != before) {
      windows.clear();
      for (const auto k : result.line)
        windows.push_back(window_at(k * periods, periods, samples / 2));
      before = periods;
    }
    result.records.push_back({record.experiment, record.realisation,
                              cleaned(record.outputs, windows, result.line, periods),
                              cleaned(record.inputs, windows, result.line, periods),
                              cleaned(record.references, windows, result.line, periods)});
  }
  return result;
}

}  // namespace chladni::recordings
