#include "identification/delay.h"

#include <fmt/format.h>
#include "base/turn.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/upper_median.h"
#include "modal/stated_variances.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

// One response with its weights 1/σ, on finite lines above 0 Hz.
struct Curve {
  Eigen::VectorXd omega, weight;
  Eigen::VectorXcd value;
};

// A line that is repeated to the last bit has no variance; this least deviation keeps its weight
// finite (as in fit_data).
double least_deviation(const modal::FrfSet& set, Eigen::Index i, Eigen::Index j) {
  double largest = 0.0;
  for (const auto& line : set.value) {
    const double size = std::abs(line(i, j));
    if (std::isfinite(size)) largest = std::max(largest, size);
  }
  return 1e-9 * largest;
}

std::vector<Curve> curves(const modal::FrfSet& set) {
  const bool stated = modal::states_variances(set);
  std::vector<Curve> result;
  for (Eigen::Index j = 0; j < set.input_count(); ++j) {
    for (Eigen::Index i = 0; i < set.output_count(); ++i) {
      std::vector<double> omega;
      std::vector<double> weight;
      std::vector<Complex> value;
      const double least = least_deviation(set, i, j);
      for (std::size_t k = 0; k < set.value.size(); ++k) {
        const auto g = set.value[k](i, j);
        const double w = kTwoPi * set.frequency_hz(static_cast<Eigen::Index>(k));
        const double s = stated ? 1.0 / std::max(std::sqrt(set.variance[k](i, j)), least) : 1.0;
        if (w <= 0.0 || !std::isfinite(std::abs(g)) || !std::isfinite(s)) continue;
        omega.push_back(w);
        weight.push_back(s);
        value.push_back(g);
      }
      if (omega.empty()) continue;
      const auto n = static_cast<Eigen::Index>(omega.size());
      result.push_back({Eigen::VectorXd::Map(omega.data(), n),
                        Eigen::VectorXd::Map(weight.data(), n),
                        Eigen::VectorXcd::Map(value.data(), n)});
    }
  }
  require(!result.empty(), "delay: no finite line above 0 Hz");
  return result;
}

// Agreement of the phases with 0 and 180° after a delay is removed.
double agreement(const std::vector<Curve>& all, double delay) {
  double sum = 0.0;
  for (const auto& curve : all) {
    for (Eigen::Index k = 0; k < curve.omega.size(); ++k) {
      const auto g = curve.value(k);
      if (g == 0.0) continue;
      sum += (g * g * std::polar(1.0, 2.0 * curve.omega(k) * delay)).real() / std::norm(g);
    }
  }
  return sum;
}

// Refines a first value: Tukey's biweight on the remaining phases.
double refined(const std::vector<Curve>& all, double delay) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    std::vector<double> sizes;
    const auto phase = [&](const Curve& curve, Eigen::Index k) {
      const auto g = curve.value(k) * std::polar(1.0, curve.omega(k) * delay);
      return 0.5 * std::arg(g * g);
    };
    for (const auto& curve : all) {
      for (Eigen::Index k = 0; k < curve.omega.size(); ++k) {
        sizes.push_back(std::abs(phase(curve, k)));
      }
    }
    const double scale = std::max(6.0 * upper_median(sizes), 1e-12);
    double up = 0.0;
    double down = 0.0;
    for (const auto& curve : all) {
      for (Eigen::Index k = 0; k < curve.omega.size(); ++k) {
        const double x = phase(curve, k);
        if (std::abs(x) >= scale) continue;
        const double w = std::pow(1.0 - x * x / (scale * scale), 2);
        up += w * curve.omega(k) * x;
        down += w * curve.omega(k) * curve.omega(k);
      }
    }
    const double step = down > 0.0 ? -up / down : 0.0;
    delay += step;
    if (std::abs(step) < 1e-12 * (1e-6 + std::abs(delay))) break;
  }
  return delay;
}

// 1/(s² − 2 Re(p) s + |p|²), 1 and, with rigid-body modes, 1/s².
Eigen::MatrixXcd basis_of(const Eigen::VectorXd& omega, const Eigen::VectorXcd& pole, bool rigid) {
  Eigen::MatrixXcd basis(omega.size(), pole.size() + (rigid ? 2 : 1));
  for (Eigen::Index k = 0; k < omega.size(); ++k) {
    const Complex s(0.0, omega(k));
    for (Eigen::Index m = 0; m < pole.size(); ++m) {
      basis(k, m) = 1.0 / (s * s - 2.0 * pole(m).real() * s + std::norm(pole(m)));
    }
    basis(k, pole.size()) = 1.0;
    if (rigid) basis(k, pole.size() + 1) = 1.0 / (s * s);
  }
  return basis;
}

Eigen::MatrixXd stacked(const Eigen::MatrixXcd& rows) {
  Eigen::MatrixXd result(2 * rows.rows(), rows.cols());
  result << rows.real(), rows.imag();
  return result;
}

struct Slope {
  double gradient = 0.0, curvature = 0.0, cost = 0.0;
  Eigen::Index freedom = 0;
};

// Residual and its derivative by the delay, both orthogonal to the columns of the residues.
Slope slope(const Curve& curve, const Eigen::VectorXcd& pole, bool rigid, double delay) {
  Eigen::MatrixXd basis = stacked(curve.weight.asDiagonal() * basis_of(curve.omega, pole, rigid));
  const Eigen::VectorXd scale = basis.colwise().norm().cwiseInverse();
  basis = (basis * scale.asDiagonal()).eval();
  Eigen::VectorXcd moved(curve.value.size());
  for (Eigen::Index k = 0; k < moved.size(); ++k) {
    moved(k) = curve.weight(k) * curve.value(k) * std::polar(1.0, curve.omega(k) * delay);
  }
  Eigen::MatrixXd both(2 * moved.size(), 2);
  both.col(0) = stacked(moved);
  both.col(1) = stacked(Complex(0.0, 1.0) * curve.omega.cwiseProduct(moved));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::MatrixXd rest = both - basis * qr.solve(both);
  return {rest.col(0).dot(rest.col(1)), rest.col(1).squaredNorm(), rest.col(0).squaredNorm(),
          2 * moved.size() - basis.cols()};
}

}  // namespace

DelayEstimate phase_delay(const modal::FrfSet& set, double longest_s) {
  const auto all = curves(set);
  require(std::isfinite(longest_s) && longest_s >= 0.0, "delay: the longest one is negative");
  double fastest = 0.0;
  for (const auto& curve : all) fastest = std::max(fastest, curve.omega.maxCoeff());
  const double step = 0.25 / fastest;
  double best = 0.0;
  double most = agreement(all, 0.0);
  for (double delay = step; delay <= longest_s; delay += step) {
    const double here = agreement(all, delay);
    if (here > most) {
      most = here;
      best = delay;
    }
  }
  DelayEstimate result{.delay_s = refined(all, best), .std_s = 0.0, .how = {}};
  double square = 0.0;
  for (const auto& curve : all) {
    square += std::pow(refined({curve}, result.delay_s) - result.delay_s, 2);
  }
  const auto n = static_cast<double>(all.size());
  result.std_s = n > 1.0 ? std::sqrt(square / (n * (n - 1.0)))  // one alone differs from none
                         : std::numeric_limits<double>::infinity();
  result.how = "phases of " + fmt::to_string(all.size()) +
               " responses away from their modes; damping adds to it";
  return result;
}

DelayEstimate delay_at_poles(const modal::FrfSet& set, const Eigen::VectorXcd& pole,
                             bool rigid_modes, double start_s) {
  for (const auto& p : pole) {
    require(p.real() < 0.0 && p.imag() > 0.0, "delay: a pole does not decay");
  }
  const auto all = curves(set);
  double delay = start_s;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Slope sum;
    for (const auto& curve : all) {
      require(2 * curve.omega.size() > pole.size() + 3,
              "delay: fewer lines than poles: " + fmt::to_string(curve.omega.size()));
      const auto one = slope(curve, pole, rigid_modes, delay);
      sum.gradient += one.gradient;
      sum.curvature += one.curvature;
      sum.cost += one.cost;
      sum.freedom += one.freedom;
    }
    const double step = -sum.gradient / sum.curvature;
    delay += step;
    // Each of the two real numbers of a line has half the line's variance.
    const double per_number =
        modal::states_variances(set) ? 0.5 : sum.cost / static_cast<double>(sum.freedom);
    const double deviation = std::sqrt(per_number / sum.curvature);
    if (std::abs(step) <= 1e-4 * deviation || std::abs(step) <= 1e-15 + 1e-10 * std::abs(delay)) {
      return {delay, deviation,
              fmt::to_string(pole.size()) + " poles with real residues in " +
                  fmt::to_string(all.size()) + " responses"};
    }
  }
  throw NumericalFailure("delay: no convergence from " + fmt::format("{:.6g}", 1e6 * start_s) +
                         " us");
}

modal::FrfSet without_delay(const modal::FrfSet& set, double delay_s, double hold_sample_time_s) {
  modal::FrfSet result = set;
  for (std::size_t k = 0; k < result.value.size(); ++k) {
    const double omega = kTwoPi * set.frequency_hz(static_cast<Eigen::Index>(k));
    const double x = 0.5 * omega * hold_sample_time_s;
    require(x < 0.5 * std::numbers::pi * (1.0 + 1e-9),
            "delay: the line at " + fmt::format("{:.6g}", omega / kTwoPi) +
                " Hz lies beyond half the sampling frequency");
    const double magnitude = x > 0.0 ? std::sin(x) / x : 1.0;
    result.value[k] *= std::polar(1.0 / magnitude, omega * delay_s + x);
    for (auto* variance : {&result.variance, &result.noise_variance}) {
      if (!variance->empty()) (*variance)[k] /= magnitude * magnitude;
    }
  }
  return result;
}

}  // namespace chladni::identification
