// Counting eigenvalues in a gap, with a place to count that can be trusted.
#pragma once

#include "fem/factor/factorization.h"
#include "fem/system.h"

namespace chladni::fem {

struct Count {
  Eigen::Index below = 0;  ///< eigenvalues of K φ = λ M φ below `at`
  double at = 0.0;         ///< [s^-2]
  int attempts = 0;        ///< places that were tried
};

/// How many eigenvalues lie below some place in (low, high), the gap above the last mode found: by
/// the signs of the pivots of K − λM. Every place in the gap proves the same; where the elimination
/// cannot be trusted (Inertia::trusted) another is taken, five at most.
///
/// @param symbolic  of K and M; @param low, high  0 < low < high
/// @throws NumericalFailure  none of the places can be trusted: says the frequency and the figures
/// @throws Interrupted
/// Cost: a factorisation per attempt.
[[nodiscard]] Count counted_in_gap(const Symbolic& symbolic, const System& system, double low,
                                   double high);

}  // namespace chladni::fem
