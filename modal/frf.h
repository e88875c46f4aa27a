// Frequency response functions of a reduced model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/reduced_model.h"

namespace chladni::modal {

/// Displacement, velocity or acceleration per force: [m/N], [m/(N s)], [m/(N s²)].
enum class FrfKind { receptance, mobility, accelerance };

/// The damping of a mode: proportional to its velocity, or to its displacement at any speed (loss
/// factor 2ζ; only for the steady state, without a state space).
enum class ModalDamping { viscous, hysteretic };

/// The time factor is e^{+jωt}: a receptance above its mode lags, and its phase is in [−180°, 0] if
/// output and input are at one place.
struct Frf {
  Eigen::VectorXd frequency_hz;         ///< k
  std::vector<Eigen::MatrixXcd> value;  ///< [k], each outputs × inputs
  FrfKind kind = FrfKind::receptance;

  [[nodiscard]] Eigen::VectorXcd channel(Eigen::Index output, Eigen::Index input) const;
};

/// G(ω) = Σ φ φᵀ / (ω_k² − ω² + 2jζ_kω_kω) + R, then the dashpots: G − jω G_yd (1 + jω G_dd)⁻¹
/// G_du (Woodbury; exact for their effect on each other and on the modes). Rigid-body modes
/// contribute −φφᵀ/ω².
/// Cost: (p + d)(q + d) m per frequency.
/// @throws InvalidInput  the model does not fit together; a frequency is negative or not finite, is
///                       0 with rigid-body modes, or is that of a mode without damping
[[nodiscard]] Frf frf(const ReducedModel& model, const Eigen::VectorXd& frequency_hz,
                      FrfKind kind = FrfKind::receptance,
                      ModalDamping damping = ModalDamping::viscous);

/// The same responses converted to another kind.
/// @throws InvalidInput  division by a frequency of 0
[[nodiscard]] Frf converted(const Frf& frf, FrfKind kind);

}  // namespace chladni::modal
