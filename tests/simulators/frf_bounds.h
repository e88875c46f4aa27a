// What no unbiased estimate from a record can be better than.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulators/frf_cases.h"

namespace chladni::simulators {

/// What else is estimated along with the modes; it costs certainty.
struct FrfNuisance {
  bool residual = true;        ///< a constant p×q
  bool delay = false;          ///< one for all responses
  bool output_delays = false;  ///< one for each output instead
};

/// Standard deviations of the Cramér-Rao bound, of the modes as the channels show them (gains in).
struct FrfBounds {
  Eigen::VectorXd frequency_hz, damping;  ///< m; 0 for rigid-body modes
  /// p×m, m×q: of L and R with |L_m| / |R_m| held at its true value. Of rigid-body modes for the
  /// change of basis that moves them least.
  Eigen::MatrixXd outputs, inputs;
  /// [m], (2+p+q) squared, of (ω_m [rad/s], ζ_m, L_m, R_m), as above.
  std::vector<Eigen::MatrixXd> covariance;
  Eigen::MatrixXd rigid_covariance;  ///< of (vec L_rb, vec R_rb), that change of basis left out
  Eigen::MatrixXd rigid;             ///< p×q: of L_rb R_rb; 0×0 without rigid-body modes
  double delay_s = 0.0;              ///< 0 where it is not estimated
  Eigen::VectorXd output_delay_s;    ///< p; empty where they are not estimated
  Eigen::Index parameters = 0;       ///< free ones
};

/// From the dense Fisher information of every response, 2 Re JᴴJ/σ², with the scale between L and
/// R (rigid-body modes: the choice of basis) taken out. Values that are NaN do not count. Not for
/// modes of one frequency and damping, nor for dampers in places.
/// Cost: k pq (4m)² + (m (p + q))³; 1 s for oat4x13.
/// @throws InvalidInput      the truth has dampers in places
/// @throws NumericalFailure  the information is singular
[[nodiscard]] FrfBounds cramer_rao(const FrfCase& record, const FrfNuisance& nuisance = {});

}  // namespace chladni::simulators
