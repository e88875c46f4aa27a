#include "identification/fit_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text_stream.h"
#include "base/upper_median.h"
#include "dense/algebra.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr int kReach = Constants::polynomial_reach;
constexpr int kDegree = Constants::polynomial_degree;
constexpr Eigen::Index kFewestLines = 2 * kReach + 1;
// Receptances outside of these limits are no measurement. Within them, squares of squares are
// still finite numbers.
constexpr double kLeastSize = 1e-70, kMostSize = 1e70;

std::string response_name(const modal::FrfSet& set, Eigen::Index i, Eigen::Index j) {
  return set.outputs[static_cast<std::size_t>(i)].name + "/" +
         set.inputs[static_cast<std::size_t>(j)].name;
}

// Maps the values of 2·kReach + 1 neighbours to their differences from their polynomial. For values
// of unit variance the squared result, divided by n − kDegree − 1, has mean 1.
Eigen::MatrixXd differs_from_polynomial() {
  const Eigen::Index n = 2 * kReach + 1;
  Eigen::MatrixXd basis(n, kDegree + 1);
  for (Eigen::Index r = 0; r < n; ++r) {
    const double x = static_cast<double>(r - kReach) / kReach;
    for (int d = 0; d <= kDegree; ++d) basis(r, d) = std::pow(x, d);
  }
  const Eigen::MatrixXd q = dense::orthonormal_basis(basis);
  return Eigen::MatrixXd::Identity(n, n) - q * q.transpose();
}

// Raw variance of each line: the residual of a local polynomial through its neighbours. Then the
// median over a wider neighbourhood, because a resonance is not noise and a few lines tell
// little about a variance.
// @pre as many lines as one polynomial needs
Eigen::VectorXd variance_of_measured(const Eigen::VectorXcd& value) {
  const Eigen::Index count = value.size();
  const Eigen::Index n = 2 * kReach + 1;
  static const Eigen::MatrixXd left_over = differs_from_polynomial();
  Eigen::VectorXd raw(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index first = std::clamp<Eigen::Index>(k - kReach, 0, count - n);
    raw(k) = (left_over * value.segment(first, n)).squaredNorm() / (n - kDegree - 1);
  }
  Eigen::VectorXd smooth(count);
  std::vector<double> window;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index first = std::max<Eigen::Index>(0, k - Constants::variance_reach);
    const Eigen::Index last = std::min(count - 1, k + Constants::variance_reach);
    window.assign(raw.data() + first, raw.data() + last + 1);
    smooth(k) = upper_median(window);
  }
  return smooth;
}

// Lines that are not measured are left out; their neighbours then count as adjacent.
Eigen::VectorXd local_variance(const Eigen::VectorXcd& value, const Eigen::VectorXd& there) {
  std::vector<Eigen::Index> measured;
  for (Eigen::Index k = 0; k < value.size(); ++k) {
    if (there(k) > 0.0) measured.push_back(k);
  }
  Eigen::VectorXd result = Eigen::VectorXd::Zero(value.size());
  result(measured) = variance_of_measured(value(measured));
  return result;
}

// RMS of |G| over a line and two on each side: a weight from the noisy line itself biases a fit.
Eigen::VectorXd smoothed_magnitude(const Eigen::VectorXcd& value, const Eigen::VectorXd& there) {
  Eigen::VectorXd result(value.size());
  for (Eigen::Index k = 0; k < value.size(); ++k) {
    const Eigen::Index first = std::max<Eigen::Index>(0, k - 2);
    const Eigen::Index n = std::min(value.size() - 1, k + 2) - first + 1;
    const double lines = there.segment(first, n).sum();
    result(k) = lines > 0.0 ? std::sqrt(value.segment(first, n).squaredNorm() / lines) : 0.0;
  }
  return result;
}

void check_size(double size, const modal::FrfSet& set, Eigen::Index i, Eigen::Index j,
                Eigen::Index line) {
  if (size <= kMostSize) return;
  TextWriter text;
  text << "response " << response_name(set, i, j) << " at " << set.frequency_hz(line)
       << " Hz: " << size << " m/N, expected a response of less than " << kMostSize;
  throw InvalidInput(text.str());
}

// One response of the set in the form that the fit uses.
struct Response {
  Eigen::VectorXcd value;
  Eigen::VectorXd there;     // 1 where it is measured, else 0
  Eigen::VectorXd variance;  // 0: not stated
};

// The median of the variances above 0 that are nearest to line k.
double variance_nearby(const Eigen::VectorXd& variance, Eigen::Index k) {
  std::vector<double> near;
  for (Eigen::Index by = 1;
       std::ssize(near) < 2 * Constants::variance_reach && by < variance.size(); ++by) {
    for (const Eigen::Index line : {k - by, k + by}) {
      const bool within = line >= 0 && line < variance.size();
      if (within && variance(line) > 0.0) near.push_back(variance(line));
    }
  }
  return upper_median(near);
}

// A variance of 0 beside others above 0 is none: the line has that of its neighbours. A line whose
// value is 0 as well was not measured, as exporters write lines that were not excited.
void fill_variances(Response& one) {
  if (!(one.variance.maxCoeff() > 0.0)) return;
  const Eigen::VectorXd stated = one.variance;
  for (Eigen::Index k = 0; k < stated.size(); ++k) {
    if (one.there(k) == 0.0 || stated(k) > 0.0) continue;
    if (one.value(k) == 0.0) {
      one.there(k) = 0.0;
    } else {
      one.variance(k) = variance_nearby(stated, k);
    }
  }
}

Response response_of(const modal::FrfSet& set, Eigen::Index i, Eigen::Index j) {
  const Eigen::Index count = set.line_count();
  Response one{Eigen::VectorXcd::Zero(count), Eigen::VectorXd::Zero(count),
               Eigen::VectorXd::Zero(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto value = set.value[static_cast<std::size_t>(k)](i, j);
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) continue;
    check_size(std::abs(value), set, i, j, k);
    one.value(k) = value;
    one.there(k) = 1.0;
    if (set.variance.empty()) continue;
    const double variance = set.variance[static_cast<std::size_t>(k)](i, j);
    if (!(variance >= 0.0)) {
      throw InvalidInput("response " + response_name(set, i, j) + " at " +
                         fmt::format("{:.6g}", set.frequency_hz(k)) + " Hz: variance " +
                         fmt::format("{:.6g}", variance) + ", expected 0 or more");
    }
    one.variance(k) = variance;
  }
  fill_variances(one);
  return one;
}

bool states_variance(const Response& one) { return one.variance.maxCoeff() > 0.0; }

// All responses, that of (i, j) at i + p j. Where others state a variance, one of zeros alone, its
// variance too, was not measured: exporters write so what a matrix of responses lacks.
std::vector<Response> responses_of(const modal::FrfSet& set) {
  std::vector<Response> all;
  for (Eigen::Index j = 0; j < set.input_count(); ++j) {
    for (Eigen::Index i = 0; i < set.output_count(); ++i) all.push_back(response_of(set, i, j));
  }
  if (std::ranges::none_of(all, states_variance)) return all;
  for (auto& one : all) {
    if (one.value.isZero(0.0) && !states_variance(one)) one.there.setZero();
  }
  return all;
}

void check_lines(const Response& one, const std::string& name) {
  const auto measured = static_cast<Eigen::Index>(one.there.sum());
  require(measured >= kFewestLines,
          "response " + name + ": measured on " + fmt::to_string(measured) + " of " +
              fmt::to_string(one.there.size()) +
              " lines in the band (not where it is NaN, or 0 beside a variance of 0), expected " +
              fmt::to_string(kFewestLines) +
              " or more; set all its values to NaN, so that it counts as not measured");
  require(one.value.cwiseAbs().maxCoeff() > kLeastSize,
          "response " + name +
              ": all its lines are zero (less than 1e-70 m/N); set them to NaN if it was not "
              "measured");
}

// Variances are stated of all responses that were measured, or of none, because zeros are none.
void check_variance(const Response& one, const std::string& name) {
  require(states_variance(one),
          "response " + name +
              ": its variance is 0 on all lines, those of others are not; expected variances above "
              "0, or no variance of any response");
}

Eigen::VectorXd weights(const Response& one, const FitDataOptions& options, double largest) {
  const Eigen::VectorXd magnitude = smoothed_magnitude(one.value, one.there);
  Eigen::VectorXd deviation(one.value.size());
  if (options.weighting == Weighting::inverse_magnitude) {
    const double least = largest * std::pow(10.0, -options.cut_off_db / 20.0);
    deviation = magnitude.cwiseMax(least);
    if (options.clip_db > 0.0) {
      const double most = magnitude.maxCoeff() * std::pow(10.0, -options.clip_db / 20.0);
      deviation = deviation.cwiseMin(std::max(most, least));
    }
  } else {
    Eigen::VectorXd variance = one.variance;
    if (variance.maxCoeff() == 0.0) variance = local_variance(one.value, one.there);
    // A line that is repeated to the last bit has no variance; the floor keeps its weight finite.
    const double floor = std::pow(1e-9 * magnitude.maxCoeff(), 2);
    deviation =
        (variance.array().max(floor) + (options.model_error * magnitude.array()).square()).sqrt();
  }
  return (one.there.array() > 0.0).select(deviation.cwiseInverse(), 0.0);
}

double largest_magnitude(const modal::FrfSet& set) {
  double largest = 0.0;
  for (const auto& line : set.value) {
    largest = std::max(largest, line.array().isFinite().select(line.cwiseAbs(), 0.0).maxCoeff());
  }
  return largest;
}

// Values and weights of the responses that were measured.
void fill(FitData& data, const modal::FrfSet& set, const std::vector<Response>& all,
          const FitDataOptions& options) {
  const double largest = largest_magnitude(set);
  data.value.setZero(set.line_count(), std::ssize(all));
  data.weight.setZero(set.line_count(), std::ssize(all));
  for (Eigen::Index e = 0; e < std::ssize(all); ++e) {
    const auto& one = all[static_cast<std::size_t>(e)];
    if (one.there.sum() == 0.0) continue;
    const auto name = response_name(set, e % data.outputs, e / data.outputs);
    check_lines(one, name);
    if (data.noise_stated) check_variance(one, name);
    data.value.col(e) = one.value;
    data.weight.col(e) = weights(one, options, largest);
  }
}

// The part of the squared deviations that is not the stated variance, over what was measured.
double share_of_model_error(const FitData& data, const std::vector<Response>& all) {
  double noise = 0.0;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    noise += all[static_cast<std::size_t>(e)].variance.dot(data.weight.col(e).cwiseAbs2());
  }
  const double measured = 0.5 * static_cast<double>(data.measured_count());
  return std::clamp(1.0 - noise / std::max(1.0, measured), 0.0, 1.0);
}

constexpr double kLeastFreedom = 2.0;  // of a variance, so that its inverse has a mean square

// Number of neighbours that share one variance. For means over W lines with ν degrees of freedom in
// all, the second differences of the logarithms have a variance of 4/(νW); for single lines 6/ν.
// First differences would contain the slope of the true variance.
double lines_of_one_variance(const FitData& data) {
  constexpr double kMedianSquare = 0.4549;  // of a normal number of variance 1
  std::vector<double> squares;
  for (const auto column : data.weight.colwise()) {
    for (Eigen::Index k = 1; k + 1 < column.size(); ++k) {
      if (!(column.segment(k - 1, 3).minCoeff() > 0.0)) continue;
      const double ratio = column(k - 1) * column(k + 1) / (column(k) * column(k));
      squares.push_back(std::pow(2.0 * std::log(ratio), 2));
    }
  }
  if (squares.empty()) return 1.0;
  const auto lines = static_cast<double>(data.line_count());
  const double square = upper_median(squares) / kMedianSquare * data.noise_freedom;
  return square * lines <= 4.0 ? lines : std::clamp(4.0 / square, 1.0, lines);
}

}  // namespace

ExpectedCost expected_cost(const FitData& data, Eigen::Index parameters) {
  const double numbers = 0.5 * static_cast<double>(data.measured_count());
  const double taken = 0.5 * static_cast<double>(parameters);
  if (!data.noise_known || data.noise_freedom == 0.0) {
    return {numbers - taken, std::sqrt(std::max(0.0, numbers - taken))};
  }
  const double v = data.noise_freedom;
  const double mean = v / (v - 1.0);
  const double own = v * mean / (v - 2.0);
  const double shared = data.shared_lines * mean * mean / (v - 2.0);
  return {numbers * mean - taken * variance_factor(data),
          std::sqrt(std::max(0.0, numbers - taken) * (own + shared))};
}

double noise_level(const FitData& data, double cost, Eigen::Index parameters) {
  const auto expected = expected_cost(data, parameters);
  if (data.noise_known && cost <= expected.mean + Constants::no_chance * expected.deviation)
    return 1.0;
  return std::max(cost / std::max(expected.mean, 0.5), 1e-300);
}

double variance_factor(const FitData& data) {
  if (!data.noise_known || data.noise_freedom == 0.0) return 1.0;
  return data.noise_freedom / (data.noise_freedom - 2.0);
}

FitData fit_data(const modal::FrfSet& measured, const FitDataOptions& options) {
  modal::check(measured);
  const double high =
      options.high_hz > 0.0 ? options.high_hz : std::numeric_limits<double>::infinity();
  const double low = std::max(options.low_hz, std::numeric_limits<double>::min());
  const auto set = modal::converted(modal::band(measured, low, high), modal::FrfKind::receptance);
  require(set.line_count() >= kFewestLines, "fit: " + fmt::to_string(set.line_count()) +
                                                " lines above 0 Hz in the band, expected " +
                                                fmt::to_string(kFewestLines) + " or more");
  const auto all = responses_of(set);
  FitData data{set.output_count(), set.input_count(), set.frequency_hz, {}, {}};
  data.noise_stated =
      options.weighting == Weighting::variance && std::ranges::any_of(all, states_variance);
  const bool unstated = set.averages == 0.0;
  data.noise_known =
      data.noise_stated && options.model_error == 0.0 && (unstated || set.averages > kLeastFreedom);
  data.freedom_known = !data.noise_known || !unstated;
  data.weights_are_deviations = options.weighting == Weighting::variance;
  data.model_error = options.model_error;
  fill(data, set, all, options);
  if (!data.noise_known) {
    const bool few = !unstated && set.averages <= kLeastFreedom;
    data.error_share = data.noise_stated && !few ? share_of_model_error(data, all) : 1.0;
  }
  if (data.noise_known && !unstated) {
    data.noise_freedom = set.averages;
    data.shared_lines = lines_of_one_variance(data);
  }
  return data;
}

double noise_of(const FitData& data) {
  if (!data.weights_are_deviations) return std::numeric_limits<double>::quiet_NaN();
  const auto weight = data.weight.array();
  return (weight > 0.0).select(weight.max(1e-300).inverse(), 0.0).matrix().norm();
}

FitData reweighted(const FitData& data, const Eigen::MatrixXcd& fitted,
                   const FitDataOptions& options) {
  FitData result = data;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::VectorXd there = (data.weight.col(e).array() > 0.0).cast<double>();
    if (there.sum() == 0.0) continue;
    const Eigen::VectorXcd left = (data.value.col(e) - fitted.col(e)).cwiseProduct(there);
    const Eigen::VectorXd model = options.model_error * fitted.col(e).cwiseAbs();
    const double floor = std::pow(1e-9 * data.value.col(e).cwiseAbs().maxCoeff(), 2);
    const Eigen::VectorXd deviation =
        (local_variance(left, there).array().max(floor) + model.array().square()).sqrt();
    result.weight.col(e) = there.cwiseQuotient(deviation);
  }
  return result;
}

}  // namespace chladni::identification
