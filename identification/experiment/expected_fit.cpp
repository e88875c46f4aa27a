#include "identification/experiment/expected_fit.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "modal/dashpot_ratio.h"
#include "modal/frf.h"

namespace chladni::identification {
namespace {

constexpr double kSameDirection = 1e-9;
// Width of the lines that count as one, over their distance from the nearest pole. The information
// of a pole changes by (distance)⁻⁴ at most: the error is of the square of this.
constexpr double kSmoothPart = 0.02;

// Rank of the 1/s² term: channels that move one way see fewer motions than the body has.
Eigen::Index rigid_rank(const modal::ReducedModel& model) {
  if (model.rigid_count == 0) return 0;
  const Eigen::MatrixXd term = model.output_shapes.leftCols(model.rigid_count) *
                               model.input_shapes.topRows(model.rigid_count);
  const Eigen::VectorXd values = term.jacobiSvd().singularValues();
  return (values.array() > kSameDirection * values(0)).count();
}

/// Lines with the variance of each response there.
struct Lines {
  Eigen::VectorXd hz;
  Eigen::MatrixXd variance;  // K×pq
};

// Up to which frequency the responses from `hz` on are all but a straight line.
double smooth_until(const modal::ReducedModel& model, double hz) {
  double nearest = hz;  // the 1/s² term
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    const double away = std::abs(hz - model.frequency_hz(k));
    nearest = std::min(nearest, std::max(away, model.damping_ratio(k) * model.frequency_hz(k)));
  }
  return hz + kSmoothPart * nearest;
}

// Neighbours between which nothing changes count as one line, with the information of all. A long
// period has a million lines, of which some hundreds around each mode differ.
Lines thinned(const modal::ReducedModel& model, const Eigen::VectorXd& hz,
              const Eigen::MatrixXd& variance) {
  std::vector<Eigen::Index> first;
  for (Eigen::Index k = 0; k < hz.size();) {
    first.push_back(k);
    const double end = smooth_until(model, hz(k));
    do ++k;
    while (k < hz.size() && hz(k) < end);
  }
  Lines few{.hz = Eigen::VectorXd(std::ssize(first)),
            .variance = Eigen::MatrixXd(std::ssize(first), variance.cols())};
  for (Eigen::Index g = 0; g < few.hz.size(); ++g) {
    const auto begin = first[static_cast<std::size_t>(g)];
    const auto end = g + 1 < few.hz.size() ? first[static_cast<std::size_t>(g) + 1] : hz.size();
    const auto all = variance.middleRows(begin, end - begin);
    few.hz(g) = hz.segment(begin, end - begin).mean();
    few.variance.row(g) = all.cwiseInverse().colwise().sum().cwiseInverse();
  }
  return few;
}

}  // namespace

ModalFit expected_fit(const modal::ReducedModel& model, const Eigen::VectorXd& line_hz,
                      const Eigen::MatrixXd& variance) {
  const auto p = model.output_count();
  const auto q = model.input_count();
  require(variance.rows() == line_hz.size() && variance.cols() == p * q,
          "expected fit: variances of " + fmt::to_string(variance.rows()) + " lines and " +
              fmt::to_string(variance.cols()) + " responses; expected " +
              fmt::to_string(line_hz.size()) + " and " + fmt::to_string(p * q));
  require(variance.allFinite() && variance.size() > 0 && variance.minCoeff() > 0.0,
          "expected fit: a variance is not positive");
  const auto lines = thinned(model, line_hz, variance);
  const auto exact = modal::frf(model, lines.hz);
  FitData data{.outputs = p, .inputs = q, .frequency_hz = lines.hz, .value = {}, .weight = {}};
  data.value.resize(lines.hz.size(), p * q);
  for (Eigen::Index k = 0; k < lines.hz.size(); ++k) {
    data.value.row(k) = exact.value[static_cast<std::size_t>(k)].reshaped().transpose();
  }
  data.weight = lines.variance.cwiseSqrt().cwiseInverse();
  auto start = start_at(model);
  start.rigid_count = rigid_rank(model);
  return modal_fit(data, start, {.residual = true, .delay = true});
}

modal::ReducedModel with_dashpots_as_ratios(const modal::ReducedModel& model) {
  modal::ReducedModel result = model;
  if (model.damper_count() == 0) return result;
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    result.damping_ratio(k) += modal::dashpot_ratio(model, k);
  }
  result.dampers = {};
  return result;
}

modal::ReducedModel with_modes(const modal::ReducedModel& model,
                               const std::vector<Eigen::Index>& modes) {
  modal::ReducedModel result{.frequency_hz = model.frequency_hz(modes),
                             .damping_ratio = model.damping_ratio(modes),
                             .rigid_count = 0,
                             .output_shapes = model.output_shapes(Eigen::all, modes),
                             .input_shapes = model.input_shapes(modes, Eigen::all),
                             .residual = model.residual,
                             .dampers = {}};
  result.rigid_count =
      std::ranges::count_if(modes, [&](Eigen::Index mode) { return mode < model.rigid_count; });
  return result;
}

}  // namespace chladni::identification
