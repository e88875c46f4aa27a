// Balanced reduction of a control model.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "dense/linear_systems.h"
#include "modal/control_model.h"

namespace chladni::modal {
namespace {

// Poles that are smaller than this part of the highest frequency are those of rigid-body motion.
constexpr double kIntegrator = 1e-7;
// Real parts below this part of a pole are rounding.
constexpr double kUndamped = 1e-12;

struct StableSide {
  Eigen::Index integrators = 0;
  double boundary = 0.0;  // [rad/s], between the integrators and the other poles
};

StableSide stable_side(const Poles& all) {
  StableSide result;
  for (const auto& pole : all.value) {
    if (all.is_integrator(pole)) {
      ++result.integrators;
      continue;
    }
    require(
        all.is_damped(pole),
        fmt::format("balanced reduction: the pole at {:.6g} Hz has the damping ratio {:.3g}, so "
                    "the model is {}; expected damped modes",
                    std::abs(pole) / (2.0 * std::numbers::pi), -pole.real() / std::abs(pole),
                    all.is_unstable(pole) ? "unstable" : "undamped"));
    const double half = 0.5 * pole.real();
    result.boundary = result.boundary == 0.0 ? half : std::max(result.boundary, half);
  }
  return result;
}

}  // namespace

bool Poles::is_integrator(std::complex<double> pole) const { return std::abs(pole) <= integrator; }

bool Poles::is_damped(std::complex<double> pole) const {
  return !is_integrator(pole) && -pole.real() > kUndamped * std::abs(pole);
}

bool Poles::is_unstable(std::complex<double> pole) const {
  return !is_integrator(pole) && pole.real() > kUndamped * std::abs(pole);
}

double Poles::highest_hz() const {
  double highest = 0.0;
  for (const auto& pole : value) {
    if (pole.imag() != 0.0) highest = std::max(highest, std::abs(pole));
  }
  return highest / (2.0 * std::numbers::pi);
}

Poles poles(const ControlModel& model) {
  check(model);
  require(
      model.space.sample_time_s == 0.0,
      "control model: found a discrete model, expected a continuous one to have poles in rad/s");
  if (model.space.a.size() == 0) return {};
  Poles result{model.space.a.eigenvalues(), 0.0};
  result.integrator = kIntegrator * result.value.imag().cwiseAbs().maxCoeff();
  return result;
}

ReducedControlModel reduced(const ControlModel& model, Eigen::Index states) {
  check(model);
  require(model.space.sample_time_s == 0.0,
          "balanced reduction: the model is discrete; expected a continuous one, to be sampled "
          "afterwards");
  const auto found = stable_side(poles(model));
  require(states >= found.integrators && states <= model.space.a.rows(),
          fmt::format("balanced reduction: found {} states, expected {} (rigid-body motion, which "
                      "is kept) to {} (all)",
                      states, found.integrators, model.space.a.rows()));
  const auto small = dense::balanced_reduction(model.space.a, model.space.b, model.space.c,
                                               model.space.d, states, found.boundary);
  ReducedControlModel result{model, small.hankel, small.unstable, 0.0};
  result.model.space = {small.a, small.b, small.c, small.d, 0.0};
  result.model.states.clear();
  for (Eigen::Index s = 0; s < small.a.rows(); ++s) {
    result.model.states.push_back({fmt::format("reduced_{}", s + 1), ""});
  }
  const auto kept = std::max<Eigen::Index>(0, small.a.rows() - small.unstable);
  result.error_bound = 2.0 * small.hankel.tail(small.hankel.size() - kept).sum();
  return result;
}

}  // namespace chladni::modal
