// A plate with two pairs of channels, for the tests of its structure.
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <string>

#include "modal/frf.h"
#include "solved_text.h"
#include "stage/diagnosis_structure.h"

namespace chladni::stage {

inline const std::string kChannels = R"(
[[sensor]]
name = "s1"
at = ["-131 mm", "77 mm"]
direction = "z"
[[sensor]]
name = "s2"
at = ["300 mm", "200 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-131 mm", "77 mm"]
direction = "z"
[[actuator]]
name = "a2"
at = ["300 mm", "200 mm"]
direction = "z"
)";

inline const std::string kPlate = R"(title = "plate"
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "10 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "40 mm", order = 2 }
modes = { count = 40, damping_ratio = 0.005 }
)";

inline Eigen::VectorXd squares(const diagnosis::Structure& of) {
  return (2.0 * std::numbers::pi * of.frequency_hz).cwiseAbs2();
}

inline Eigen::MatrixXcd response(const diagnosis::Structure& of, double frequency_hz) {
  modal::ReducedModel model{of.frequency_hz,
                            of.damping_ratio,
                            of.rigid_count,
                            of.outputs.shapes,
                            of.inputs.shapes.transpose(),
                            of.residual,
                            {}};
  model.dampers = {Eigen::MatrixXd(0, of.mode_count()), Eigen::MatrixXd(of.output_count(), 0),
                   Eigen::MatrixXd(0, of.input_count()), Eigen::MatrixXd(0, 0)};
  return modal::frf(model, Eigen::VectorXd::Constant(1, frequency_hz)).value.front();
}

}  // namespace chladni::stage
