#include "diagnosis/modes/errors/mode_change.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ModeChange change_by(const BodyError& error, const RecordedModes& model,
                     const std::vector<Index>& modes) {
  const Index n = model.count();
  const Index r = model.motion.rows();
  const auto m = static_cast<Index>(modes.size());
  const VectorXd lambda = (2.0 * std::numbers::pi * model.frequency_hz).cwiseAbs2();
  const MatrixXd moved = model.motion(Eigen::all, modes);
  const auto in_modes = [&](const MatrixXd& of) -> MatrixXd {
    if (of.size() == 0) return MatrixXd::Zero(n, m);
    return model.motion.transpose() * MatrixXd(of.topLeftCorner(r, r) * moved);
  };
  const MatrixXd stiffness = in_modes(error.stiffness);
  const MatrixXd mass = in_modes(error.mass);
  ModeChange change{VectorXd::Zero(n), MatrixXd::Zero(model.outputs.rows(), n),
                    MatrixXd::Zero(model.inputs.rows(), n)};
  MatrixXd turn(n, m);
  for (Index c = 0; c < m; ++c) {
    const Index k = modes[at(c)];
    for (Index l = 0; l < n; ++l) {
      const double part = stiffness(l, c) - lambda(k) * mass(l, c);
      const double gap = lambda(k) - lambda(l);
      const double least = 2.0 * kConstants.least_gap * lambda(k);
      turn(l, c) =
          l == k ? -0.5 * mass(k, c) : part / std::copysign(std::max(std::abs(gap), least), gap);
      if (l == k) change.frequency(k) = 0.5 * part / lambda(k);
    }
  }
  change.outputs(Eigen::all, modes) = model.outputs * turn;
  change.inputs(Eigen::all, modes) = model.inputs * turn;
  return change;
}

}  // namespace chladni::diagnosis
