// Counts eigenvalues below a shift in a gap where the count can be trusted.
#pragma once

#include "fem/factor/factorization.h"
#include "fem/system.h"

namespace chladni::fem {

struct Count {
  Eigen::Index below = 0;  ///< eigenvalues of K φ = λ M φ below `at`
  double at = 0.0;         ///< [s^-2]
  int attempts = 0;        ///< shifts that were tried
};

/// Counts the eigenvalues below a shift λ in (low, high), the gap above the last mode found, by the
/// signs of the pivots of K − λM. Every shift in the gap gives the same proof. Where the
/// elimination cannot be trusted (Inertia::trusted), another shift is tried, at most five in all.
///
/// @param symbolic  of K and M; @param low, high  0 < low < high
/// @throws NumericalFailure  no shift can be trusted: gives the frequencies and the figures
/// @throws Interrupted
/// Cost: a factorisation per attempt.
[[nodiscard]] Count counted_in_gap(const Symbolic& symbolic, const System& system, double low,
                                   double high);

}  // namespace chladni::fem
