// Poles to start from: fast relaxed vector fitting (Gustavsen and Semlyen 1999, Gustavsen 2006,
// Deschrijver et al. 2008).
#pragma once

#include "identification/fit_data.h"

namespace chladni::identification {

struct VectorFitOptions {
  Eigen::Index order = 20;  ///< pairs of poles
  bool rigid = false;       ///< a term in 1/s² beside them, of any rank
  int iterations = 20;
  double enough = 1e-8;         ///< largest relative change of a pole at which to stop
  double enough_value = 0.0;    ///< likewise, of the cost that it linearises
  Eigen::VectorXcd start = {};  ///< [rad/s], poles known already; the others are spread
};

/// Poles [rad/s], those with Im > 0, ascending by it; Re < 0. What is not a resonance is among
/// them: each is only as good as its residues say.
/// Cost: per iteration 0.6 K·order·pq and pq·order³ operations times some ten.
/// @throws InvalidInput  fewer measured numbers than unknowns, order < 1
[[nodiscard]] Eigen::VectorXcd vector_fit(const FitData& data, const VectorFitOptions& options);

}  // namespace chladni::identification
