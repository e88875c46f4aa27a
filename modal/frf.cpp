#include "modal/frf.h"

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "base/text_stream.h"

namespace chladni::modal {
namespace {

using Complex = std::complex<double>;

[[noreturn]] void refuse(double frequency_hz, const char* what) {
  TextWriter text;
  text << "frf: the frequency " << frequency_hz << " Hz " << what;
  throw InvalidInput(text.str());
}

// Receptance of each mode.
Eigen::VectorXcd modal_receptance(const ReducedModel& model, double frequency_hz,
                                  ModalDamping damping) {
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  Eigen::VectorXcd result(model.mode_count());
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const double own = 2.0 * std::numbers::pi * model.frequency_hz(k);
    const double loss =
        2.0 * model.damping_ratio(k) * own * (damping == ModalDamping::viscous ? omega : own);
    const Complex stiffness(own * own - omega * omega, loss);
    if (stiffness == 0.0) {
      refuse(frequency_hz, k < model.rigid_count
                               ? "is that of a rigid-body mode; a free body needs frequencies "
                                 "above 0"
                               : "is that of a mode without damping; give it damping or leave the "
                                 "line out");
    }
    result(k) = 1.0 / stiffness;
  }
  return result;
}

Eigen::MatrixXcd receptance(const ReducedModel& model, double frequency_hz, ModalDamping damping) {
  const auto modes = modal_receptance(model, frequency_hz, damping);
  const auto from_to = [&](const Eigen::MatrixXd& from, const Eigen::MatrixXd& to,
                           const Eigen::MatrixXd& residual) {
    return Eigen::MatrixXcd(to * (modes.asDiagonal() * from.cast<Complex>()) + residual);
  };
  auto result = from_to(model.input_shapes, model.output_shapes, model.residual);
  if (model.damper_count() == 0) return result;
  const auto& dampers = model.dampers;
  const Eigen::MatrixXd shapes = dampers.shapes.transpose();
  const Complex s(0.0, 2.0 * std::numbers::pi * frequency_hz);
  Eigen::MatrixXcd felt = s * from_to(shapes, dampers.shapes, dampers.among);
  felt.diagonal().array() += 1.0;
  const auto speed = from_to(model.input_shapes, dampers.shapes, dampers.from_inputs);
  result -= s * from_to(shapes, model.output_shapes, dampers.to_outputs) *
            felt.partialPivLu().solve(speed);
  return result;
}

int derivatives(FrfKind kind) { return static_cast<int>(kind); }

Complex factor(double frequency_hz, int order) {
  const Complex s(0.0, 2.0 * std::numbers::pi * frequency_hz);
  Complex result = 1.0;
  for (int i = 0; i < std::abs(order); ++i) result *= s;
  return order >= 0 ? result : 1.0 / result;
}

}  // namespace

Eigen::VectorXcd Frf::channel(Eigen::Index output, Eigen::Index input) const {
  Eigen::VectorXcd result(static_cast<Eigen::Index>(value.size()));
  for (std::size_t k = 0; k < value.size(); ++k) {
    result(static_cast<Eigen::Index>(k)) = value[k](output, input);
  }
  return result;
}

Frf frf(const ReducedModel& model, const Eigen::VectorXd& frequency_hz, FrfKind kind,
        ModalDamping damping) {
  check(model);
  Frf result{.frequency_hz = frequency_hz, .value = {}, .kind = kind};
  for (const double f : frequency_hz) {
    if (!std::isfinite(f) || f < 0.0) refuse(f, "is not a frequency; expected 0 or more");
    result.value.emplace_back(receptance(model, f, damping) * factor(f, derivatives(kind)));
  }
  return result;
}

Frf converted(const Frf& frf, FrfKind kind) {
  const int order = derivatives(kind) - derivatives(frf.kind);
  Frf result{.frequency_hz = frf.frequency_hz, .value = frf.value, .kind = kind};
  for (std::size_t k = 0; k < result.value.size(); ++k) {
    const double f = frf.frequency_hz(static_cast<Eigen::Index>(k));
    if (order < 0 && f == 0.0) refuse(f, "cannot be integrated; leave the line out");
    result.value[k] *= factor(f, order);
  }
  return result;
}

}  // namespace chladni::modal
