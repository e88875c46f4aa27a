// Two codes on one matrix: whether the factorisation can be believed on this machine.
#pragma once

#include "fem/system.h"

namespace chladni::fem {

/// What our LDLᵀ, which certifies modes, and CHOLMOD's own simplicial LDLᵀ count on K − (2π f)² M,
/// and how well a solve with the Cholesky factor of K + (2π f)² M does.
struct FactorCheck {
  Eigen::Index counted = 0, counted_by_cholmod = 0;  ///< eigenvalues below f
  bool trusted = false;                              ///< what the count says of itself
  double residual = 0.0;  ///< ‖A x − b‖ / (‖A‖ ‖x‖ + ‖b‖) with Frobenius norms; rounding is 1e-16

  [[nodiscard]] bool good() const {
    return trusted && counted == counted_by_cholmod && residual < 1e-14;
  }
};

/// @param hz  f, not a natural frequency; above 0 [Hz]
/// @throws NumericalFailure  K + (2π f)² M is not positive definite
[[nodiscard]] FactorCheck factor_check(const System& system, double hz);

}  // namespace chladni::fem
