#include "identification/poles/vector_fit.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "base/finite.h"
#include "base/interrupt.h"
#include "dense/blas.h"
#include "identification/constants.h"
#include "identification/likelihood/block_model.h"
#include "identification/poles/denominator.h"
#include "identification/poles/pole_products.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

// Equally spaced; if the band spans two decades, half of them are spaced by a constant ratio.
Eigen::VectorXcd start_poles(const Eigen::VectorXd& x, Eigen::Index order) {
  const double low = std::max(x(0), 1e-4 * x(x.size() - 1));
  const double high = x(x.size() - 1);
  const Eigen::Index by_ratio = high > 100.0 * low ? order / 2 : 0;
  std::vector<double> at;
  for (Eigen::Index i = 0; i < by_ratio; ++i) {
    at.push_back(
        low * std::pow(high / low, (static_cast<double>(i) + 0.5) / static_cast<double>(by_ratio)));
  }
  const Eigen::Index even = order - by_ratio;
  for (Eigen::Index i = 0; i < even; ++i) {
    at.push_back(low + (high - low) * (static_cast<double>(i) + 0.5) / static_cast<double>(even));
  }
  std::sort(at.begin(), at.end());
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] < at[i - 1] * (1.0 + 1e-4)) at[i] = at[i - 1] * (1.0 + 1e-4);
  }
  Eigen::VectorXcd poles(order);
  for (Eigen::Index i = 0; i < order; ++i) {
    poles(i) = at[static_cast<std::size_t>(i)] * Complex(-Constants::even_damping, 1.0);
  }
  return poles;
}

// Known poles, and spread ones up to the order.
Eigen::VectorXcd with_known(const Eigen::VectorXcd& known, const Eigen::VectorXd& x,
                            Eigen::Index order) {
  const auto spread = start_poles(x, std::max<Eigen::Index>(0, order - known.size()));
  Eigen::VectorXcd all(known.size() + spread.size());
  all << known, spread;
  return all;
}

// Zeros of d + Σ c φ: eigenvalues of A − b cᵀ/d.
Eigen::VectorXcd zeros(const Eigen::VectorXcd& poles, const Eigen::VectorXd& c) {
  const auto n = poles.size();
  double constant = c(2 * n);
  if (std::abs(constant) < 1e-8) constant = constant < 0.0 ? -1e-8 : 1e-8;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index u = 0; u < n; ++u) {
    const Complex p = poles(u);
    a.block(2 * u, 2 * u, 2, 2) << p.real(), p.imag(), -p.imag(), p.real();
    a.row(2 * u) -= 2.0 / constant * c.head(2 * n).transpose();
  }
  return finite(a, "vector fit").eigenvalues();
}

// Makes n pairs again: turns unstable poles over, joins two real poles to a pair of their product.
Eigen::VectorXcd pairs_of(const Eigen::VectorXcd& all) {
  std::vector<Complex> upper;
  std::vector<double> real;
  for (const Complex& p : all) {
    const double r = -std::max(std::abs(p.real()), kLeastDampingRatio * std::abs(p));
    if (p.imag() > 1e-12 * std::abs(p)) upper.emplace_back(r, p.imag());
    if (std::abs(p.imag()) <= 1e-12 * std::abs(p)) real.push_back(std::max(-r, 1e-9));
  }
  std::sort(real.begin(), real.end());
  for (std::size_t i = 0; i + 1 < real.size(); i += 2) {
    const double own = std::sqrt(real[i] * real[i + 1]);
    upper.emplace_back(-0.7 * own, 0.7 * own);
  }
  std::sort(upper.begin(), upper.end(),
            [](const Complex& a, const Complex& b) { return a.imag() < b.imag(); });
  // Coinciding poles would make the products singular.
  for (std::size_t i = 1; i < upper.size(); ++i) {
    if (std::abs(upper[i] - upper[i - 1]) < 1e-9 * std::abs(upper[i])) upper[i] *= 1.0 + 1e-6;
  }
  return Eigen::Map<const Eigen::VectorXcd>(upper.data(), static_cast<Eigen::Index>(upper.size()));
}

double largest_change(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  if (a.size() != b.size()) return 1.0;
  return ((a - b).cwiseAbs().array() / a.cwiseAbs().array()).maxCoeff();
}

}  // namespace

Eigen::VectorXcd vector_fit(const FitData& data, const VectorFitOptions& options) {
  require(options.order >= 1,
          "vector fit: order " + fmt::to_string(options.order) + ", expected 1 or more");
  const auto unknowns = 2 * options.order + 1;
  require(2 * data.line_count() > 2 * unknowns + 1,
          "vector fit: " + fmt::to_string(data.line_count()) + " lines are too few for " +
              fmt::to_string(options.order) + " modes");
  const double scale = 2.0 * std::numbers::pi * data.frequency_hz(data.line_count() - 1);
  const Eigen::VectorXd x = 2.0 * std::numbers::pi / scale * data.frequency_hz;
  PoleProducts products(data, x, options.rigid);
  Eigen::VectorXcd poles = with_known(options.start / scale, x, options.order);
  const dense::OneBlasThread one_thread;
  double value = 0.0;
  for (int i = 0; i < options.iterations; ++i) {
    throw_if_interrupted();
    products.set_poles(poles);
    const auto sums = products.sums();
    auto found = least_denominator(denominator_by_sums(products), sums);
    if (!found.sound()) {
      found = least_denominator(denominator_by_rows(data, x, poles, options.rigid), sums);
    }
    if (!found.coefficient.allFinite()) {
      throw NumericalFailure(
          "vector fit: the responses determine no poles; are they constant, or beyond what is "
          "measured?");
    }
    const auto next = pairs_of(zeros(poles, found.coefficient));
    const double change = largest_change(next, poles);
    poles = next;
    const bool settled = std::abs(found.left - value) < options.enough_value * value;
    value = found.left;
    if (change < options.enough || settled) break;
  }
  return scale * poles;
}

}  // namespace chladni::identification
