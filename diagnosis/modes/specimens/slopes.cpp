#include "diagnosis/modes/specimens/slopes.h"

#include <cmath>
#include <numbers>
#include <string_view>

#include "base/index.h"
#include "diagnosis/modes/specimens/specimen_constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// d ln f of modes of unit modal mass, where stiffness and mass change by these.
VectorXd change_of_frequencies(const RecordedModes& model, const MatrixXd& stiffness,
                               const MatrixXd& mass) {
  VectorXd change(model.count());
  for (Index k = 0; k < change.size(); ++k) {
    const VectorXd shape = model.motion.col(k);
    const double lambda = std::pow(2.0 * std::numbers::pi * model.frequency_hz(k), 2);
    change(k) = 0.5 * (shape.dot(stiffness * shape) / lambda - shape.dot(mass * shape));
  }
  return change;
}

State with_constants(const ModesProblem& problem, VectorXd x) {
  ModesFit there;
  there.constants = std::move(x);
  return problem.with(there);
}

double coordinate_of(const ModesProblem& problem, const ModesFit& fit, std::string_view effect) {
  for (std::size_t c = 0; c < problem.constants().size(); ++c) {
    if (problem.constants()[c].effect->name == effect) {
      return fit.constants(static_cast<Index>(c));
    }
  }
  return 0.0;
}

}  // namespace

MatrixXd frequency_slopes(const ModesProblem& problem, const ModesFit& fit,
                          const RecordedModes& model) {
  const Index c = fit.constants.size();
  MatrixXd slopes(model.count(), c);
  for (Index i = 0; i < c; ++i) {
    const VectorXd step = kSpecimens.slope_step * VectorXd::Unit(c, i);
    const State more = with_constants(problem, fit.constants + step);
    const State less = with_constants(problem, fit.constants - step);
    slopes.col(i) =
        change_of_frequencies(model, more.stiffness - less.stiffness, more.mass - less.mass) /
        (2.0 * kSpecimens.slope_step);
  }
  return slopes;
}

VectorXd length_slopes(const ModesProblem& problem, const ModesFit& fit, const RecordedModes& model,
                       bool along_u) {
  const auto factor = [&](std::string_view effect, double power = 1.0) {
    return std::exp(power * coordinate_of(problem, fit, effect));
  };
  const auto& parts = problem.structure().directional;
  const double u = factor("stiffness_along_u"), v = factor("stiffness_along_v");
  const MatrixXd own = along_u ? u * parts.along_u : v * parts.along_v;
  const MatrixXd other = along_u ? v * parts.along_v : u * parts.along_u;
  const MatrixXd both = v * parts.across + factor("shear_stiffness") * parts.shear;
  const double whole =
      factor("youngs_modulus") * factor("thickness", problem.structure().bending_power);
  const State state = with_constants(problem, fit.constants);
  MatrixXd mass = state.mass;
  if (state.masses.size() > 0) mass -= state.masses;
  return change_of_frequencies(model, whole * (-3.0 * own + other - both), mass);
}

}  // namespace chladni::diagnosis
