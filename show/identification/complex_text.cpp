#include "show/identification/complex_text.h"

#include <fmt/format.h>

namespace chladni::show {
namespace {

// Phase collinearity of each mode's shapes at the sensors and at the actuators.
struct Collinearity {
  Eigen::VectorXd outputs, inputs;
};

Collinearity collinearity(const identification::ComplexShapes& shapes) {
  const auto n = shapes.outputs.cols();
  Collinearity result{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index m = 0; m < n; ++m) {
    result.outputs(m) = identification::phase_collinearity(shapes.outputs.col(m));
    result.inputs(m) = identification::phase_collinearity(shapes.inputs.row(m).transpose());
  }
  return result;
}

}  // namespace

io::Json complex_json(const identification::ComplexShapes& shapes) {
  const auto phases = collinearity(shapes);
  return io::JsonObject{{"output_real", io::Json::rows(shapes.outputs.real())},
                        {"output_imaginary", io::Json::rows(shapes.outputs.imag())},
                        {"output_real_std", io::Json::rows(shapes.output_real_std)},
                        {"output_imaginary_std", io::Json::rows(shapes.output_imaginary_std)},
                        {"input_real", io::Json::rows(shapes.inputs.real())},
                        {"input_imaginary", io::Json::rows(shapes.inputs.imag())},
                        {"input_real_std", io::Json::rows(shapes.input_real_std)},
                        {"input_imaginary_std", io::Json::rows(shapes.input_imaginary_std)},
                        {"output_phase_collinearity", io::Json(phases.outputs)},
                        {"input_phase_collinearity", io::Json(phases.inputs)}};
}

std::string complex_table(const identification::ModalFit& fit) {
  const auto phases = collinearity(*fit.complex);
  std::string text = fmt::format("\n{:>4} {:>34} {:>24}\n", "mode", "phase collinearity at sensors",
                                 "at actuators");
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    text += fmt::format("{:>4} {:>34.5f} {:>24.5f}\n", m + 1, phases.outputs(m), phases.inputs(m));
  }
  return text;
}

}  // namespace chladni::show
