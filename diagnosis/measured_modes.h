// Measured modes in the form that a diagnosis uses: frequencies, damping and shapes, without
// responses.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/modal_fit.h"

namespace chladni::diagnosis {

/// m modes at p sensors and q actuators, ascending in frequency. NaN: not measured.
struct MeasuredModes {
  std::vector<std::string> outputs, inputs;  ///< p, q names; q may be 0
  Eigen::VectorXd frequency_hz;              ///< m, above 0
  Eigen::VectorXd frequency_std;             ///< m, relative; 0: exact
  Eigen::VectorXd damping_ratio;             ///< m; NaN: not measured
  Eigen::VectorXd damping_std;               ///< m, of its logarithm
  /// p×m: shapes as the sensors record them, with one unknown complex factor for each mode.
  Eigen::MatrixXcd output_shapes;
  Eigen::MatrixXd output_std;     ///< p×m, of the real and of the imaginary part, in the same unit
  Eigen::MatrixXcd input_shapes;  ///< q×m: the same at the actuators
  Eigen::MatrixXd input_std;      ///< q×m
  /// True: output_shapes(i, k) · input_shapes(j, k) is the residue of response (i, j) [1/kg], as in
  /// G = Σ residue / (ω_k² − ω² + 2i ζ_k ω_k ω). False: the product has no known scale.
  bool scaled = false;

  [[nodiscard]] Eigen::Index count() const { return frequency_hz.size(); }
};

/// @throws InvalidInput  sizes differ; a frequency that is not positive or not finite; frequencies
///                       that do not ascend; a deviation that is negative or not finite
void check(const MeasuredModes& modes);

/// The modes of these numbers, in their order.
[[nodiscard]] MeasuredModes part(const MeasuredModes& all, const std::vector<Eigen::Index>& modes);

/// "the mode at 120.3 Hz".
[[nodiscard]] std::string mode_name(const MeasuredModes& modes, Eigen::Index i);

/// The modes of a fit that lie within the band and that the data support (compare.h). The channels
/// are those of the fit, in its order. A number whose deviation is infinite, as that of a damping
/// ratio at its bound, is not measured.
[[nodiscard]] MeasuredModes measured_modes(const identification::ModalFit& fit,
                                           std::vector<std::string> outputs,
                                           std::vector<std::string> inputs, double low_hz,
                                           double high_hz);

}  // namespace chladni::diagnosis
