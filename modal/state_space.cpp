#include "modal/state_space.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "dense/linear_systems.h"

namespace chladni::modal {
namespace {

// Dashpots in the principal directions of their residual flexibility R = Q diag(r) Qᵀ.
//
// At a dashpot the structure moves with v = Φ q̇ + R_du u̇ + R f˙, and f = −v. If r > 0 this is a
// state z = f + R_du u / r with ż = −(f + Φ q̇) / r. If r = 0 (then R_du = 0 too), f = −Φ q̇.
struct PrincipalDampers {
  Eigen::MatrixXd soft_shapes, soft_from_inputs, soft_to_outputs;  // s rows, s rows, s columns
  Eigen::VectorXd lag;                                             // r, s [s]
  Eigen::MatrixXd stiff_shapes;
};

PrincipalDampers principal(const ReducedModel& model) {
  const auto m = model.mode_count();
  PrincipalDampers result{.soft_shapes = Eigen::MatrixXd(0, m),
                          .soft_from_inputs = Eigen::MatrixXd(0, model.input_count()),
                          .soft_to_outputs = Eigen::MatrixXd(model.output_count(), 0),
                          .lag = Eigen::VectorXd(0),
                          .stiff_shapes = Eigen::MatrixXd(0, m)};
  const auto d = model.damper_count();
  if (d == 0) return result;
  const auto& dampers = model.dampers;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dampers.among);
  // Residuals that are only rounding relative to the modes' part at the same place are zero.
  const auto flexible = m - model.rigid_count;
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * model.frequency_hz.tail(flexible);
  const double modal =
      (dampers.shapes.rightCols(flexible) * omega.cwiseInverse().asDiagonal()).squaredNorm();
  Eigen::Index stiff = 0;
  while (stiff < d && solver.eigenvalues()(stiff) <= 1e-12 * modal) ++stiff;
  const Eigen::MatrixXd directions = solver.eigenvectors().rightCols(d - stiff);
  result.lag = solver.eigenvalues().tail(d - stiff);
  result.soft_shapes = directions.transpose() * dampers.shapes;
  result.soft_from_inputs = directions.transpose() * dampers.from_inputs;
  result.soft_to_outputs = dampers.to_outputs * directions;
  result.stiff_shapes = solver.eigenvectors().leftCols(stiff).transpose() * dampers.shapes;
  return result;
}

}  // namespace

StateSpace state_space(const ReducedModel& model, FrfKind output) {
  check(model);
  const auto m = model.mode_count();
  const auto dampers = principal(model);
  const auto s = dampers.lag.size();
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * model.frequency_hz;
  Eigen::VectorXd scale = omega;
  scale.head(model.rigid_count).setOnes();
  const Eigen::MatrixXd rate = dampers.lag.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd feed = rate * dampers.soft_from_inputs;  // f = z − feed u

  StateSpace result;
  result.a.setZero(2 * m + s, 2 * m + s);
  result.a.block(0, m, m, m) = scale.asDiagonal();
  result.a.block(m, 0, m, m) = -omega.cwiseAbs2().cwiseQuotient(scale).asDiagonal().toDenseMatrix();
  result.a.block(m, m, m, m) = -dampers.stiff_shapes.transpose() * dampers.stiff_shapes;
  result.a.block(m, m, m, m).diagonal() -= 2.0 * model.damping_ratio.cwiseProduct(omega);
  result.a.block(m, 2 * m, m, s) = dampers.soft_shapes.transpose();
  result.a.block(2 * m, m, s, m) = -rate * dampers.soft_shapes;
  result.a.block(2 * m, 2 * m, s, s) = -rate;
  result.b.setZero(2 * m + s, model.input_count());
  result.b.middleRows(m, m) = model.input_shapes - dampers.soft_shapes.transpose() * feed;
  result.b.bottomRows(s) = rate * feed;

  result.c.setZero(model.output_count(), 2 * m + s);
  result.d.setZero(model.output_count(), model.input_count());
  if (output == FrfKind::receptance) {
    result.c.leftCols(m) = model.output_shapes * scale.cwiseInverse().asDiagonal();
    result.c.rightCols(s) = dampers.soft_to_outputs;
    result.d = model.residual - dampers.soft_to_outputs * feed;
  } else if (output == FrfKind::mobility) {
    result.c.middleCols(m, m) = model.output_shapes;
  } else {
    result.c = model.output_shapes * result.a.middleRows(m, m);
    result.d = model.output_shapes * result.b.middleRows(m, m);
  }
  return result;
}

StateSpace discretised(const StateSpace& model, double sample_time_s) {
  require(model.sample_time_s == 0.0, "state space: the model is discrete already");
  require(std::isfinite(sample_time_s) && sample_time_s > 0.0,
          "state space: the sample time is " + fmt::to_string(sample_time_s) +
              " s; expected a positive number");
  const auto [exponential, integral] = dense::exponential_with_integral(model.a, sample_time_s);
  return {.a = exponential,
          .b = integral * model.b,
          .c = model.c,
          .d = model.d,
          .sample_time_s = sample_time_s};
}

Eigen::MatrixXcd response(const StateSpace& model, double frequency_hz) {
  require(
      std::isfinite(frequency_hz) && frequency_hz >= 0.0,
      "state space: the frequency is " + fmt::to_string(frequency_hz) + " Hz; expected 0 or more");
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_hz);
  Eigen::MatrixXcd pencil = -model.a.cast<std::complex<double>>();
  pencil.diagonal().array() += model.sample_time_s > 0.0 ? std::exp(s * model.sample_time_s) : s;
  const Eigen::MatrixXcd states = pencil.partialPivLu().solve(model.b.cast<std::complex<double>>());
  return model.c * states + model.d;
}

}  // namespace chladni::modal
