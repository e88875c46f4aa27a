// Delays of a continuous model as Padé approximations.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "modal/control_model.h"

namespace chladni::modal {
namespace {

// Coefficients of the denominator Σ a_k s^k of the Padé approximation [n/n] of e^{−s}:
// a_k = (2n − k)! n! / ((2n)! k! (n − k)!).
Eigen::VectorXd denominator(int n) {
  Eigen::VectorXd a(n + 1);
  a(0) = 1.0;
  for (int k = 1; k <= n; ++k) {
    a(k) = a(k - 1) * (n - k + 1) / (static_cast<double>(k) * (2 * n - k + 1));
  }
  return a;
}

// α of the continued fraction α₁ s + 1 / (α₂ s + 1 / (α₃ s + …)) of the part of `a` with its
// highest power over the other part, even over odd or odd over even (Routh). All are positive,
// because the zeros of `a` have negative real parts.
Eigen::VectorXd ladder(const Eigen::VectorXd& a) {
  const auto n = a.size() - 1;
  Eigen::VectorXd alpha(n);
  Eigen::VectorXd upper = Eigen::VectorXd::Zero(n + 1);
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(n + 1);
  for (Eigen::Index k = 0; k <= n; ++k) (k % 2 == 0 ? upper : lower)(k / 2) = a(n - k);
  for (Eigen::Index k = 0; k < n; ++k) {
    alpha(k) = upper(0) / lower(0);
    Eigen::VectorXd rest = Eigen::VectorXd::Zero(n + 1);
    rest.head(n) = upper.tail(n) - alpha(k) * lower.tail(n);
    upper = lower;
    lower = rest;
  }
  return alpha;
}

// e^{−sτ} as (−1)ⁿ (1 − 2 / (1 + α₁ s τ + 1 / (α₂ s τ + …))): a ladder without losses, closed by a
// resistance. Its controllability Gramian is the unit matrix over 2.
StateSpace pade(double delay_s, int order) {
  const Eigen::VectorXd alpha = ladder(denominator(order)) * delay_s;
  const double sign = order % 2 == 0 ? 1.0 : -1.0;
  StateSpace space;
  space.a.setZero(order, order);
  space.b.setZero(order, 1);
  space.c.setZero(1, order);
  space.a(0, 0) = -1.0 / alpha(0);
  for (int k = 0; k + 1 < order; ++k) {
    const double between = 1.0 / std::sqrt(alpha(k) * alpha(k + 1));
    space.a(k, k + 1) = -between;
    space.a(k + 1, k) = between;
  }
  space.b(0, 0) = 1.0 / std::sqrt(alpha(0));
  space.c(0, 0) = -2.0 * sign * space.b(0, 0);
  space.d = Eigen::MatrixXd::Constant(1, 1, sign);
  return space;
}

void grow(StateSpace& space, Eigen::Index count) {
  const auto n = space.a.rows();
  space.a.conservativeResizeLike(Eigen::MatrixXd::Zero(n + count, n + count));
  space.b.conservativeResizeLike(Eigen::MatrixXd::Zero(n + count, space.b.cols()));
  space.c.conservativeResizeLike(Eigen::MatrixXd::Zero(space.c.rows(), n + count));
}

// The delay in front of input j.
void put_before(const StateSpace& delay, Eigen::Index j, StateSpace& space) {
  const auto n = space.a.rows();
  const auto r = delay.a.rows();
  const Eigen::VectorXd b = space.b.col(j);
  const Eigen::VectorXd d = space.d.col(j);
  grow(space, r);
  space.a.bottomRightCorner(r, r) = delay.a;
  space.a.topRightCorner(n, r) = b * delay.c;
  space.b.col(j) << b * delay.d(0, 0), delay.b;
  space.c.rightCols(r) = d * delay.c;
  space.d.col(j) = d * delay.d(0, 0);
}

// The delay behind output i.
void put_after(const StateSpace& delay, Eigen::Index i, StateSpace& space) {
  const auto n = space.a.rows();
  const auto r = delay.a.rows();
  const Eigen::RowVectorXd c = space.c.row(i);
  const Eigen::RowVectorXd d = space.d.row(i);
  grow(space, r);
  space.a.bottomRightCorner(r, r) = delay.a;
  space.a.bottomLeftCorner(r, n) = delay.b * c;
  space.b.bottomRows(r) = delay.b * d;
  space.c.row(i) << delay.d(0, 0) * c, delay.c;
  space.d.row(i) = delay.d(0, 0) * d;
}

void name_states(const Signal& channel, int order, ControlModel& model) {
  for (int k = 1; k <= order; ++k) {
    model.states.push_back({fmt::format("{}_pade_{}", channel.name, k),
                            channel.unit.empty() ? "" : channel.unit + " s^1/2"});
  }
}

void require_order(int order) {
  require(order >= 1 && order <= kHighestPade,
          fmt::format("control model: the order of a Padé approximation is {}; expected 1 to {}",
                      order, kHighestPade));
}

}  // namespace

ControlModel with_pade_delays(const ControlModel& model, int order) {
  check(model);
  require(model.space.sample_time_s == 0.0,
          "control model: a discrete model has its delays without an approximation");
  require_order(order);
  ControlModel result = model;
  for (Eigen::Index j = 0; j < model.input_delay.size(); ++j) {
    if (model.input_delay(j) == 0.0) continue;
    put_before(pade(model.input_delay(j), order), j, result.space);
    name_states(model.inputs[static_cast<std::size_t>(j)], order, result);
  }
  for (Eigen::Index i = 0; i < model.output_delay.size(); ++i) {
    if (model.output_delay(i) == 0.0) continue;
    put_after(pade(model.output_delay(i), order), i, result.space);
    name_states(model.outputs[static_cast<std::size_t>(i)], order, result);
  }
  result.input_delay.setZero();
  result.output_delay.setZero();
  return result;
}

double pade_limit_hz(const ControlModel& model, int order, double phase_error) {
  require_order(order);
  double longest = 0.0;
  if (model.input_delay.size() > 0) longest = model.input_delay.maxCoeff();
  if (model.output_delay.size() > 0) longest = std::max(longest, model.output_delay.maxCoeff());
  if (longest == 0.0) return std::numeric_limits<double>::infinity();
  // The error of the phase is (n!)² / ((2n)! (2n + 1)!) (ωτ)^{2n+1} and higher powers.
  const double factor = 2.0 * std::lgamma(order + 1.0) - std::lgamma(2.0 * order + 1.0) -
                        std::lgamma(2.0 * order + 2.0);
  const double turned = std::exp((std::log(phase_error) - factor) / (2.0 * order + 1.0));
  return turned / (2.0 * std::numbers::pi * longest);
}

}  // namespace chladni::modal
