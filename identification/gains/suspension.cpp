#include "identification/suspension.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Part of a shape that no rigid motion explains, relative to the shape. NaN: the
// places do not tell.
double bent_part(const Eigen::VectorXd& shape, const Eigen::MatrixXd& directions) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(directions);
  if (directions.rows() <= directions.cols() || qr.rank() < directions.cols()) return kUnknown;
  const double size = shape.norm();
  return size > 0.0 ? (shape - directions * qr.solve(shape)).norm() / size : kUnknown;
}

// The same part at the side with more channels, or at the other side where that one does not tell.
double bent_part(const ModalFit& fit, Eigen::Index mode, const Eigen::MatrixXd& outputs,
                 const Eigen::MatrixXd& inputs) {
  const double left = bent_part(fit.model.output_shapes.col(mode), outputs);
  const double right = bent_part(fit.model.input_shapes.row(mode).transpose(), inputs);
  const bool sensors = outputs.rows() >= inputs.rows();
  const double first = sensors ? left : right;
  return std::isfinite(first) ? first : (sensors ? right : left);
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
