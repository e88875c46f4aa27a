// Balanced reduction of a control model.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "dense/linear_systems.h"
#include "modal/control_model.h"

namespace chladni::modal {
namespace {

// Poles that are smaller than this part of the largest one are those of rigid-body motion.
constexpr double kIntegrator = 1e-7;

struct Poles {
  Eigen::Index integrators = 0;
  double boundary = 0.0;  // [rad/s], between the integrators and the other poles
};

Poles poles(const StateSpace& space) {
  const Eigen::VectorXcd values = space.a.eigenvalues();
  const double largest = values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0.0;
  Poles result;
  for (const auto& pole : values) {
    if (std::abs(pole) <= kIntegrator * largest) {
      ++result.integrators;
      continue;
    }
    require(
        pole.real() < 0.0,
        fmt::format("balanced reduction: the pole at {:.6g} Hz has the damping ratio {:.3g}, so "
                    "the model is {}; expected damped modes",
                    std::abs(pole) / (2.0 * std::numbers::pi), -pole.real() / std::abs(pole),
                    pole.real() > 0.0 ? "unstable" : "undamped"));
    const double half = 0.5 * pole.real();
    result.boundary = result.boundary == 0.0 ? half : std::max(result.boundary, half);
  }
  return result;
}

}  // namespace

ReducedControlModel reduced(const ControlModel& model, Eigen::Index states) {
  check(model);
  require(model.space.sample_time_s == 0.0,
          "balanced reduction: the model is discrete; expected a continuous one, to be sampled "
          "afterwards");
  const auto found = poles(model.space);
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
    result.model.states.push_back({fmt::format("balanced_{}", s + 1), ""});
  }
  const auto kept = std::max<Eigen::Index>(0, small.a.rows() - small.unstable);
  result.error_bound = 2.0 * small.hankel.tail(small.hankel.size() - kept).sum();
  return result;
}

}  // namespace chladni::modal
