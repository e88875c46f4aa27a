// A reduced model as ẋ = A x + B u, y = C x + D u.
#pragma once

#include <Eigen/Core>

#include "modal/frf.h"
#include "modal/reduced_model.h"

namespace chladni::modal {

/// u: forces [N]; y: displacements, velocities or accelerations.
struct StateSpace {
  Eigen::MatrixXd a, b, c, d;
  double sample_time_s = 0.0;  ///< 0: continuous; else x[k+1] = A x[k] + B u[k]
};

/// States: ω_k q_k of each mode (q_k for a rigid-body mode, a double integrator), then q̇_k, then
/// the force of each dashpot whose place has residual flexibility, because d(residual)/dt is part
/// of its velocity. For displacements the residual flexibility is in D. A proper model of
/// velocities or accelerations cannot contain it: there its direct path to the outputs is left out.
/// The response equals frf() with viscous damping.
/// @throws InvalidInput  the model does not fit together
[[nodiscard]] StateSpace state_space(const ReducedModel& model,
                                     FrfKind output = FrfKind::receptance);

/// Exact for inputs that are constant between samples (zero-order hold, by the matrix exponential
/// and its integral).
/// @throws InvalidInput  the sample time is not positive, or the model is discrete already
[[nodiscard]] StateSpace discretised(const StateSpace& model, double sample_time_s);

/// C (z − A)⁻¹ B + D at z = jω, or at e^{jωT} for a discrete model. @throws InvalidInput  f < 0
[[nodiscard]] Eigen::MatrixXcd response(const StateSpace& model, double frequency_hz);

}  // namespace chladni::modal
