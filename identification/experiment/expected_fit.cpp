#include "identification/experiment/expected_fit.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/turn.h"
#include "modal/frf.h"

namespace chladni::identification {
namespace {

constexpr double kSameDirection = 1e-9;

// Rank of the 1/s² term: channels that move one way see fewer motions than the body has.
Eigen::Index rigid_rank(const modal::ReducedModel& model) {
  if (model.rigid_count == 0) return 0;
  const Eigen::MatrixXd term = model.output_shapes.leftCols(model.rigid_count) *
                               model.input_shapes.topRows(model.rigid_count);
  const Eigen::VectorXd values = term.jacobiSvd().singularValues();
  return (values.array() > kSameDirection * values(0)).count();
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
  const auto exact = modal::frf(model, line_hz);
  FitData data{.outputs = p, .inputs = q, .frequency_hz = line_hz, .value = {}, .weight = {}};
  data.value.resize(line_hz.size(), p * q);
  for (Eigen::Index k = 0; k < line_hz.size(); ++k) {
    data.value.row(k) = exact.value[static_cast<std::size_t>(k)].reshaped().transpose();
  }
  data.weight = variance.cwiseSqrt().cwiseInverse();
  auto start = start_at(model);
  start.rigid_count = rigid_rank(model);
  return modal_fit(data, start, {.residual = true, .delay = true});
}

modal::ReducedModel with_dashpots_as_ratios(const modal::ReducedModel& model) {
  modal::ReducedModel result = model;
  if (model.damper_count() == 0) return result;  // their shapes may be of no mode then
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    result.damping_ratio(k) +=
        model.dampers.shapes.col(k).squaredNorm() / (2.0 * kTwoPi * model.frequency_hz(k));
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
