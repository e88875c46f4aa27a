#include "diagnosis/error_band.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>
#include <utility>

#include "dense/blas.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/verdict/prepared.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Σ |x|² over the measured responses of each line, of weighted real parts and imaginary parts.
Eigen::ArrayXd power_of_lines(const Observed& observed, const Eigen::VectorXd& weighted) {
  const Index numbers = observed.value.size();
  const Eigen::ArrayXXd weight2 = observed.weight.array().square();
  const Eigen::ArrayXXd power =
      (weighted.head(numbers).array().square() + weighted.tail(numbers).array().square())
          .reshaped(observed.value.rows(), observed.value.cols());
  return (weight2 > 0.0).select(power / weight2.max(1e-300), 0.0).rowwise().sum();
}

// Σ over the deviations. What moves a resonance far changes a response by no more than its size,
// so each slope is bounded by it.
Eigen::VectorXd model_power(const Problem& problem) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(std::ssize(problem.deviations));
  const auto& observed = problem.observed;
  const State state = state_of(problem, {}, rest);
  const Solved now = solved(state, Body(state, observed.omega));
  const Eigen::MatrixXd slopes = sensitivities(problem, {}, rest, now);
  const Eigen::ArrayXd size = power_of_lines(observed, weighted(observed, now.value)).max(1e-300);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(observed.line_count());
  for (Index d = 0; d < slopes.cols(); ++d) {
    const Eigen::ArrayXd power = power_of_lines(observed, slopes.col(d));
    sum += power / (1.0 + power / size);
  }
  return sum;
}

}  // namespace

ErrorBand error_band(const Structure& structure, const modal::FrfSet& measured,
                     const Tolerances& tolerances) {
  const dense::OneBlasThread one_thread;
  constexpr Index lines_at_once = 128;
  const auto given = prepared(structure, measured, tolerances);
  const auto deviations = given.all_deviations();
  const auto& all = given.observed;
  const Index lines = all.line_count();
  ErrorBand band{all.omega / (2.0 * std::numbers::pi), Eigen::VectorXd(lines),
                 Eigen::VectorXd(lines)};
  for (Index first = 0; first < lines; first += lines_at_once) {
    const auto rows = Eigen::seqN(first, std::min(lines_at_once, lines - first));
    Observed some = all;
    some.omega = all.omega(rows);
    some.value = all.value(rows, Eigen::all);
    some.weight = all.weight(rows, Eigen::all);
    band.model(rows) = model_power({*given.structure, some, deviations, given.solver_error});
    const Eigen::ArrayXXd weight2 = some.weight.array().square();
    band.noise(rows) = (weight2 > 0.0).select(2.0 / weight2.max(1e-300), 0.0).rowwise().sum();
  }
  return band;
}

}  // namespace chladni::diagnosis
