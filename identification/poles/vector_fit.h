// Start poles: fast relaxed vector fitting (Gustavsen and Semlyen 1999, Gustavsen 2006,
// Deschrijver et al. 2008).
#pragma once

#include "identification/fit_data.h"

namespace chladni::identification {

struct VectorFitOptions {
  Eigen::Index order = 20;  ///< pairs of poles
  bool rigid = false;       ///< a term in 1/s² beside them, of any rank
  int iterations = 20;
  double enough = 1e-8;         ///< largest relative change of a pole at which it stops
  double enough_value = 0.0;    ///< the same for the linearised cost
  Eigen::VectorXcd start = {};  ///< [rad/s], known poles; the others are spread over the band
};

/// Poles [rad/s] with Im > 0 in ascending order; Re < 0. Some are no resonances: their residues
/// tell which poles matter.
/// Cost: per iteration 0.6 K·order·pq and some ten times pq·order³ operations.
/// @throws InvalidInput      fewer measured numbers than unknowns, order < 1
/// @throws NumericalFailure  the responses determine no poles
[[nodiscard]] Eigen::VectorXcd vector_fit(const FitData& data, const VectorFitOptions& options);

}  // namespace chladni::identification
