#include "recordings/estimate/local_transient.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/turn.h"
#include "dense/algebra.h"
#include "recordings/fft.h"
#include "recordings/recordings.h"

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
  window.fit = dense::inverse_of(qr);
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

/// The lines of the transform of all periods that fits need, by their residue after division by
/// the number of periods.
struct NeededLines {
  std::vector<Index> lines;                // ascending
  std::map<Index, std::vector<Index>> of;  // by residue: places in `lines`

  [[nodiscard]] Index place(Index line) const {
    return std::lower_bound(lines.begin(), lines.end(), line) - lines.begin();
  }
};

// The transform of all P periods of N samples on those lines. On line kP + r it is line k of the
// transform of e^{−j2πrn/PN} Σ_p e^{−j2πrp/P} x_p(n): one transform of a period for each r.
Eigen::VectorXcd transform_on(const NeededLines& needed, const Recordings& recordings,
                              std::size_t record, Side side, Index channel) {
  const auto n = recordings.head.period;
  const auto periods = recordings.records[record].samples / n;
  const auto turn = [](Index part, Index whole) {
    return std::polar(1.0,
                      -kTwoPi * static_cast<double>(part % whole) / static_cast<double>(whole));
  };
  Eigen::MatrixXcd folded = Eigen::MatrixXcd::Zero(n, std::ssize(needed.of));
  for (Index p = 0; p < periods; ++p) {
    const auto x = recordings.samples(record, side, channel, p * n, n);
    Index column = 0;
    for (const auto& [residue, places] : needed.of) {
      folded.col(column++) += turn(residue * p, periods) * x.cast<std::complex<double>>();
    }
  }
  Eigen::VectorXcd result(std::ssize(needed.lines));
  Index column = 0;
  for (const auto& [residue, places] : needed.of) {
    auto one = folded.col(column++);
    for (Index i = 0; i < n; ++i) one(i) *= turn(residue * i, periods * n);
    const Eigen::VectorXcd real = fourier(one.real()).col(0);
    const Eigen::VectorXcd imaginary = fourier(one.imag()).col(0);
    for (const auto place : places) {
      const Index k = needed.lines[static_cast<std::size_t>(place)] / periods;
      result(place) = real(k) + std::complex<double>(0.0, 1.0) * imaginary(k);
    }
  }
  return result;
}

/// The windows of the lines of a period, in records of one number of periods.
struct Windows {
  Windows(const std::vector<Index>& line, Index of, Index samples) : periods(of) {
    std::set<Index> all;
    for (const auto k : line) {
      windows.push_back(window_at(k * periods, periods, samples / 2));
      all.insert(k * periods);
      all.insert(windows.back().lines.begin(), windows.back().lines.end());
    }
    needed.lines.assign(all.begin(), all.end());
    for (Index place = 0; place < std::ssize(needed.lines); ++place) {
      needed.of[needed.lines[static_cast<std::size_t>(place)] % periods].push_back(place);
    }
    for (std::size_t i = 0; i < windows.size(); ++i) {
      own.push_back(needed.place(line[i] * periods));
      for (auto& at : windows[i].lines) at = needed.place(at);
    }
  }

  Index periods = 0;
  std::vector<Window> windows;  // their lines are places in `needed`
  std::vector<Index> own;       // of the lines of the period
  NeededLines needed;
};

// The spectra of one channel of a record, from the transform on the needed lines.
// @param result  [pseudo-period] K×channels
void clean(const Eigen::VectorXcd& all, const Windows& of, Index channel,
           std::vector<Eigen::MatrixXcd>& result) {
  static const Eigen::MatrixXd spread = helmert(kFreedom);
  const auto of_all = static_cast<double>(of.periods);
  for (std::size_t k = 0; k < of.own.size(); ++k) {
    const auto& window = of.windows[k];
    // Σ|Δ|² / (P'(P' − 1)) is then the variance of the mean.
    const double scale =
        std::sqrt(static_cast<double>(kFreedom + 1) * (1.0 + window.leverage)) / of_all;
    const Eigen::VectorXcd around = all(window.lines);
    const auto fit = best(window, around);
    const auto mean = (all(of.own[k]) - fit.transient) / of_all;
    const Eigen::VectorXcd deviation = scale * (spread * (window.rest * fit.left));
    for (Index p = 0; p <= kFreedom; ++p) {
      result[static_cast<std::size_t>(p)](static_cast<Index>(k), channel) = mean + deviation(p);
    }
  }
}

// The record's wanted sides.
Spectra::Record cleaned(const Recordings& recordings, std::size_t i, const Windows& windows,
                        const std::vector<Side>& sides) {
  const auto side_of = [&](Side side, const std::vector<modal::MeasuredChannel>& channels) {
    const auto count = std::ranges::count(sides, side) > 0 ? std::ssize(channels) : 0;
    std::vector<Eigen::MatrixXcd> result(static_cast<std::size_t>(kFreedom + 1),
                                         Eigen::MatrixXcd(std::ssize(windows.own), count));
    for (Index c = 0; c < count; ++c) {
      clean(transform_on(windows.needed, recordings, i, side, c), windows, c, result);
    }
    return result;
  };
  const auto& head = recordings.head;
  const auto& place = recordings.records[i];
  return {place.experiment, place.realisation, side_of(Side::outputs, head.outputs),
          side_of(Side::inputs, head.inputs), side_of(Side::references, head.references)};
}

}  // namespace

Index periods_without_start() { return kFreedom + 1; }

double lines_apart(const std::vector<Index>& line, Index periods, Index period) {
  std::vector<Window> windows;
  for (const auto k : line) {
    windows.push_back(window_at(k * periods, periods, periods * period / 2));
  }
  double shared = 0.0;
  for (const auto& one : windows) {
    for (const auto& other : windows) {
      Eigen::MatrixXd common = Eigen::MatrixXd::Zero(kFreedom, kFreedom);
      for (Index i = 0; i < kNeighbours; ++i) {
        const auto at = std::ranges::find(other.lines, one.lines[static_cast<std::size_t>(i)]);
        if (at == other.lines.end()) continue;
        common += one.rest.col(i) * other.rest.col(at - other.lines.begin()).transpose();
      }
      shared += common.squaredNorm();
    }
  }
  const auto count = static_cast<double>(line.size());
  return static_cast<double>(kFreedom) * count * count / shared;
}

RecordWithoutStart record_without_start(const Recordings& recordings, std::vector<Index> line) {
  return [&recordings, line = std::move(line), windows = std::optional<Windows>()](
             std::size_t i, const std::vector<Side>& sides) mutable {
    const auto samples = recordings.records[i].samples;
    const auto periods = samples / recordings.head.period;
    require(periods >= 2,
            "transient: a record of one period; expected two or more, or transient = \"drop\"");
    if (!windows || windows->periods != periods) windows.emplace(line, periods, samples);
    return cleaned(recordings, i, *windows, sides);
  };
}

Spectra without_start(const TimeData& data, double low_hz, double high_hz) {
  check(data);
  check_periods(data);
  auto result = lines_between(data, low_hz, high_hz);
  const auto recordings = recordings_of(data);
  result.cleaned_periods = fewest_periods(recordings);
  const auto record = record_without_start(recordings, result.line);
  for (std::size_t i = 0; i < data.records.size(); ++i) {
    result.records.push_back(record(i, {Side::outputs, Side::inputs, Side::references}));
  }
  return result;
}

}  // namespace chladni::recordings
