#include "identification/suspension.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A mode at the channels of one side that know it, and the rigid motions there.
struct Side {
  Eigen::VectorXd shape;       // n
  Eigen::MatrixXd directions;  // n×r
};

// A channel that was not measured has no deviation; its value says nothing. Without deviations all
// are known.
Side known_side(const Eigen::VectorXd& shape, const Eigen::VectorXd& deviation,
                const Eigen::MatrixXd& directions) {
  if (deviation.size() != shape.size()) return {shape, directions};
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < shape.size(); ++i) {
    if (std::isfinite(deviation(i))) known.push_back(i);
  }
  return {shape(known), directions(known, Eigen::all)};
}

Side outputs_of(const ModalFit& fit, Eigen::Index mode, const Eigen::MatrixXd& directions) {
  const bool has = mode < fit.output_std.cols();
  return known_side(fit.model.output_shapes.col(mode),
                    has ? Eigen::VectorXd(fit.output_std.col(mode)) : Eigen::VectorXd(),
                    directions);
}

Side inputs_of(const ModalFit& fit, Eigen::Index mode, const Eigen::MatrixXd& directions) {
  const bool has = mode < fit.input_std.rows();
  return known_side(fit.model.input_shapes.row(mode).transpose(),
                    has ? Eigen::VectorXd(fit.input_std.row(mode).transpose()) : Eigen::VectorXd(),
                    directions);
}

// Part of a shape that no rigid motion explains, relative to the shape. NaN: the
// places do not tell.
double bent_part(const Side& side) {
  const auto& directions = side.directions;
  if (directions.rows() <= directions.cols()) return kUnknown;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(directions);
  if (qr.rank() < directions.cols()) return kUnknown;
  const double size = side.shape.norm();
  return size > 0.0 ? (side.shape - directions * qr.solve(side.shape)).norm() / size : kUnknown;
}

// The same part at the side with more channels, or at the other side where that one does not tell.
double bent_part(const ModalFit& fit, Eigen::Index mode, const Eigen::MatrixXd& outputs,
                 const Eigen::MatrixXd& inputs) {
  const auto at_outputs = outputs_of(fit, mode, outputs);
  const auto at_inputs = inputs_of(fit, mode, inputs);
  const bool sensors = at_outputs.shape.size() >= at_inputs.shape.size();
  const double first = bent_part(sensors ? at_outputs : at_inputs);
  return std::isfinite(first) ? first : bent_part(sensors ? at_inputs : at_outputs);
}

Suspension lowest(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                  const Eigen::MatrixXd& inputs, Eigen::Index count) {
  Suspension found;
  const auto& frequency = fit.model.frequency_hz;
  const auto first = fit.model.rigid_count;
  for (auto m = first; m < first + count; ++m) {
    found.modes.push_back(m);
    const double bent = bent_part(fit, m, outputs, inputs);
    if (std::isfinite(bent)) found.bending = std::max(found.bending, bent);
  }
  if (count > 0 && first + count < fit.model.mode_count()) {
    const double ratio = frequency(first + count - 1) / frequency(first + count);
    found.bending = std::max(found.bending, ratio * ratio);
  }
  return found;
}

}  // namespace

Suspension suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                      const Eigen::MatrixXd& inputs) {
  const auto& frequency = fit.model.frequency_hz;
  if (fit.model.rigid_count > 0) return {};
  Eigen::Index count = 0;
  const auto most = std::min(outputs.cols(), fit.model.mode_count());
  while (count < most && bent_part(fit, count, outputs, inputs) < Constants::suspended_bent)
    ++count;
  while (count > 0 && !(count < fit.model.mode_count() &&
                        Constants::suspended_apart * frequency(count - 1) < frequency(count))) {
    --count;
  }
  return lowest(fit, outputs, inputs, count);
}

Suspension stated_suspension(const ModalFit& fit, const Eigen::MatrixXd& outputs,
                             const Eigen::MatrixXd& inputs, Eigen::Index count) {
  const auto flexible = fit.flexible_count();
  require(count >= 0 && count <= std::min(flexible, outputs.cols()),
          fmt::to_string(count) + " suspended modes of " + fmt::to_string(flexible) +
              " above 0 Hz and " + fmt::to_string(outputs.cols()) +
              " motions of the body as a whole");
  return lowest(fit, outputs, inputs, count);
}

}  // namespace chladni::identification
