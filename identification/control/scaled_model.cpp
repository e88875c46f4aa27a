#include "identification/control/scaled_model.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <complex>
#include <optional>

namespace chladni::identification {

std::vector<modal::Signal> complex_states(const modal::ReducedModel& model) {
  std::vector<modal::Signal> states;
  for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
    const bool rigid = m < model.rigid_count;
    states.push_back({fmt::format("mode_{}_{}", m + 1, rigid ? "position" : "real"),
                      rigid ? "kg^1/2 m" : "kg^1/2 m / s^1/2"});
    states.push_back({fmt::format("mode_{}_{}", m + 1, rigid ? "velocity" : "imaginary"),
                      rigid ? "kg^1/2 m/s" : states.back().unit});
  }
  return states;
}

namespace {

// T with own ≈ T matched, by least squares; none where the rows do not determine it.
template <typename Matrix>
std::optional<Matrix> turn(const Matrix& own, const Matrix& matched) {
  const Matrix found =
      matched.transpose().colPivHouseholderQr().solve(Matrix(own.transpose())).transpose();
  if (!found.allFinite() || !Eigen::FullPivLU<Matrix>(found).isInvertible()) return std::nullopt;
  return found;
}

template <typename Matrix>
void change(Eigen::Index first, Eigen::Index count, const Matrix& matched, Matrix& outputs,
            Matrix& inputs) {
  if (count == 0) return;
  const Matrix own = inputs.middleRows(first, count);
  const auto t = turn<Matrix>(own, matched.middleRows(first, count));
  if (!t) return;
  outputs.middleCols(first, count) = (outputs.middleCols(first, count) * *t).eval();
  inputs.middleRows(first, count) = Eigen::FullPivLU<Matrix>(*t).solve(own);
}

// Delays of the channels of one side, as the fit has them.
Eigen::VectorXd delays(const ModalFit& fit, Eigen::Index count, bool own) {
  Eigen::VectorXd delay = Eigen::VectorXd::Zero(count);
  if (own) delay.setConstant(fit.delay_s);
  if (own && fit.channel_delay_s.size() == count) delay += fit.channel_delay_s;
  return delay.cwiseMax(0.0);
}

}  // namespace

modal::ReducedModel in_scale_of(const GainMatch& match, modal::ReducedModel model) {
  auto& outputs = model.output_shapes;
  auto& inputs = model.input_shapes;
  const Eigen::MatrixXd matched = driving_shapes(match);
  change(0, model.rigid_count, matched, outputs, inputs);
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    change(m, 1, matched, outputs, inputs);
  }
  if (model.residual.size() == 0) {
    model.residual.setZero(model.output_count(), model.input_count());
  }
  return model;
}

ComplexShapes in_scale_of(const GainMatch& match, const ModalFit& fit,
                          const ComplexShapes& shapes) {
  const auto rigid = fit.model.rigid_count;
  ComplexShapes scaled;
  scaled.outputs = shapes.outputs;
  scaled.inputs = shapes.inputs;
  Eigen::MatrixXd outputs = shapes.outputs.real();
  Eigen::MatrixXd inputs = shapes.inputs.real();
  const Eigen::MatrixXd real = driving_shapes(match);
  change(0, rigid, real, outputs, inputs);
  scaled.outputs.leftCols(rigid) = outputs.leftCols(rigid).cast<std::complex<double>>();
  scaled.inputs.topRows(rigid) = inputs.topRows(rigid).cast<std::complex<double>>();
  const Eigen::MatrixXcd matched =
      real.cast<std::complex<double>>() +
      std::complex<double>(0.0, 1.0) * driving_imaginary(match).cast<std::complex<double>>();
  for (auto m = rigid; m < fit.model.mode_count(); ++m) {
    change(m, 1, matched, scaled.outputs, scaled.inputs);
  }
  return scaled;
}

void set_delays(const ModalFit& fit, modal::ControlModel& model) {
  const bool of_outputs = fit.delay_of == DelayOf::outputs;
  model.output_delay.head(fit.model.output_count()) =
      delays(fit, fit.model.output_count(), of_outputs);
  model.input_delay.head(fit.model.input_count()) =
      delays(fit, fit.model.input_count(), !of_outputs);
}

}  // namespace chladni::identification
