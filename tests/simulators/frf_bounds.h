// The Cramér-Rao bound: no unbiased estimate from a record can be better.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulators/frf_cases.h"

namespace chladni::simulators {

/// Further quantities that are estimated with the modes. They increase the uncertainty.
struct FrfNuisance {
  bool residual = true;        ///< a constant p×q
  bool delay = false;          ///< one for all responses
  bool output_delays = false;  ///< one for each output instead
};

/// Standard deviations of the Cramér-Rao bound, of the modes as the channels show them (gains
/// included).
struct FrfBounds {
  Eigen::VectorXd frequency_hz, damping;  ///< m; 0 for rigid-body modes
  /// p×m, m×q: of L and R with |L_m| / |R_m| held at its true value. For rigid-body modes, the
  /// basis is the one that moves them least.
  Eigen::MatrixXd outputs, inputs;
  /// [m], (2+p+q) squared, of (ω_m [rad/s], ζ_m, L_m, R_m), as above.
  std::vector<Eigen::MatrixXd> covariance;
  Eigen::MatrixXd rigid_covariance;  ///< of (vec L_rb, vec R_rb), without changes of basis
  Eigen::MatrixXd rigid;             ///< p×q: of L_rb R_rb; 0×0 without rigid-body modes
  double delay_s = 0.0;              ///< 0 where it is not estimated
  Eigen::VectorXd output_delay_s;    ///< p; empty where they are not estimated
  Eigen::Index parameters = 0;       ///< number of free parameters
};

/// Computes the bound from the dense Fisher information of every response, 2 Re JᴴJ/σ². The scale
/// between L and R (for rigid-body modes the choice of basis) is removed. Values that are NaN do
/// not count. Not for modes with equal frequency and damping, nor for dampers at places.
/// Cost: k pq (4m)² + (m (p + q))³; 1 s for oat4x13.
/// @throws InvalidInput      the truth has dampers at places
/// @throws NumericalFailure  the information is singular
[[nodiscard]] FrfBounds cramer_rao(const FrfCase& record, const FrfNuisance& nuisance = {});

}  // namespace chladni::simulators
