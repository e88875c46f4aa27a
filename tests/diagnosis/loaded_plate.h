// A plate whose modes all differ, its modes as they are recorded, and as they are measured.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/modes/errors/mode_errors.h"
#include "diagnosis/small_plate.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {

inline constexpr Eigen::Index kModes = 9;

// The plate with two masses: no two of its modes have one frequency.
[[nodiscard]] inline State loaded() {
  State state = state_of(small_plate());
  const auto add = [&](std::string_view name, double size, double u, double v) {
    effect(name).apply(state, small_plate(), 0, Eigen::Vector3d(size, u, v));
  };
  add("point_mass", 1.5, 0.21, 0.08);
  add("point_mass", 0.8, -0.05, -0.27);
  return state;
}

[[nodiscard]] inline RecordedModes modes_of(const State& state) {
  static const ModeSolver solver(state_of(small_plate()), small_plate().mode_count());
  return solver.modes(state, 0.0, std::numeric_limits<double>::infinity());
}

// The first modes of a model as they are recorded, each value with an error.
[[nodiscard]] inline MeasuredModes measured_of(const RecordedModes& model, double error,
                                               unsigned seed = 1) {
  simulators::Dice dice(seed);
  MeasuredModes modes;
  modes.outputs = small_plate().outputs.names;
  modes.inputs = small_plate().inputs.names;
  const Eigen::Index m = std::min(kModes, model.count());
  modes.frequency_hz = model.frequency_hz.head(m);
  modes.damping_ratio = model.damping_ratio.head(m);
  modes.frequency_std = modes.damping_std = Eigen::VectorXd::Zero(m);
  const auto record = [&](const Eigen::MatrixXd& shapes, const Eigen::MatrixXcd& path) {
    Eigen::MatrixXcd all = path.leftCols(m).cwiseProduct(shapes.leftCols(m));
    for (Eigen::Index k = 0; k < m; ++k) {
      const double size = error * all.col(k).norm() / std::sqrt(static_cast<double>(all.rows()));
      for (Eigen::Index i = 0; i < all.rows(); ++i) {
        all(i, k) += size * std::complex<double>(dice.normal(), 0.3 * dice.normal());
      }
    }
    return all;
  };
  modes.output_shapes = record(model.outputs, model.output_path);
  modes.input_shapes = record(model.inputs, model.input_path);
  modes.output_std = Eigen::MatrixXd::Constant(modes.output_shapes.rows(), m, 1e-3);
  modes.input_std = Eigen::MatrixXd::Constant(modes.input_shapes.rows(), m, 1e-3);
  return modes;
}

[[nodiscard]] inline ShapeUnits some_units() { return {0.3, 0.35}; }

[[nodiscard]] inline const std::vector<BodyError>& body() {
  static const auto made = body_errors(small_plate(), Tolerances{});
  return made;
}

[[nodiscard]] inline ModeErrors errors_of(const MeasuredModes& measured, const RecordedModes& model,
                                          const Matching& matching,
                                          const std::vector<bool>& shares) {
  static const Eigen::MatrixXd smooth = smooth_factor(small_plate());
  return mode_errors(small_plate(), measured, model, some_units(), matching, body(), smooth, {},
                     shares);
}
[[nodiscard]] inline ModeErrors errors_of(const MeasuredModes& measured, const RecordedModes& model,
                                          const Matching& matching, bool with_shared = true) {
  return errors_of(measured, model, matching,
                   std::vector<bool>(static_cast<std::size_t>(measured.count()), with_shared));
}
[[nodiscard]] inline Matching matched_by_shape(const MeasuredModes& measured,
                                               const RecordedModes& model) {
  return matched(measured, model, some_units());
}

}  // namespace chladni::diagnosis
