#include "identification/likelihood/levenberg.h"

#include <cmath>
#include <limits>

#include "base/interrupt.h"
#include "dense/algebra.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

// Solves (N + λ diag N) x = g, scaled to a unit diagonal. Empty if that is not positive definite.
Eigen::VectorXd damped_step(const NormalEquations& normal, double damping) {
  const Eigen::VectorXd scale = normal.matrix.diagonal()
                                    .cwiseMax(std::numeric_limits<double>::min())
                                    .cwiseSqrt()
                                    .cwiseInverse();
  Eigen::MatrixXd scaled = normal.matrix;
  for (Eigen::Index c = 0; c < scaled.cols(); ++c) {
    scaled.col(c).tail(scaled.rows() - c).array() *=
        scale(c) * scale.tail(scaled.rows() - c).array();
  }
  scaled.diagonal().array() += damping;
  if (!dense::cholesky(scaled)) return {};
  Eigen::MatrixXd x = scale.cwiseProduct(normal.gradient);
  dense::solve(scaled, x);
  dense::solve_transposed(scaled, x);
  return scale.cwiseProduct(x.col(0));
}

bool is_stable(const BlockModel& model) {
  for (const auto& block : model.blocks) {
    if (!is_stable(block)) return false;
  }
  return true;
}

// Takes one accepted step; false if no damping helps.
bool step_down(Descent& now, double& damping, const Target& target, const Fitted& fitted) {
  const auto normal = normal_equations(now.model, now.misfit, target, fitted);
  for (; damping < Constants::largest_step_damping; damping *= 8.0) {
    const auto step = damped_step(normal, damping);
    if (step.size() == 0 || !step.allFinite()) continue;
    auto trial = moved(now.model, step, fitted);
    if (!is_stable(trial)) continue;
    auto misfit_there = misfit(trial, target, fitted);
    if (!(misfit_there.cost < now.misfit.cost)) continue;
    now.model = std::move(trial);
    now.misfit = std::move(misfit_there);
    damping = std::max(1e-12, damping / 10.0);
    return true;
  }
  return false;
}

}  // namespace

Descent descent(BlockModel start, const Target& target, const Fitted& fitted,
                const DescentOptions& options) {
  Descent now{std::move(start), {}, 0, false};
  now.misfit = misfit(now.model, target, fitted);
  const double round_off = 1e-28 * target.total;
  double damping = options.damping;
  int quiet = 0;
  while (now.iterations < options.iterations && quiet < 2 && now.misfit.cost > round_off) {
    if (options.keep_best && interrupted()) return now;
    throw_if_interrupted();
    const double before = now.misfit.cost;
    const bool undamped = damping <= Constants::undamped;
    if (!step_down(now, damping, target, fitted)) {
      quiet = 2;
      break;
    }
    ++now.iterations;
    const bool little =
        before - now.misfit.cost < Constants::enough_decrease * target.noise_level(now.misfit.cost);
    quiet = little ? (undamped ? 2 : quiet + 1) : 0;
    tell(options.progress, "fitting", static_cast<double>(now.iterations) / options.iterations);
  }
  now.converged = quiet >= 2 || now.misfit.cost <= round_off;
  return now;
}

}  // namespace chladni::identification
