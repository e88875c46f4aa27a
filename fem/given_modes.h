// Modes that another program has computed, checked with our own K and M.
#pragma once

#include "fem/modes.h"

namespace chladni::fem {

/// The shift s of K + sM, (2π shift_hz)². With 0: the square of about twice the first flexible
/// frequency, which conditions the factor well; any value from a tenth to a hundred times that
/// serves. [s^-2]
[[nodiscard]] double inverted_shift(const System& system, double shift_hz = 0.0);

/// All modes below a bound, the rigid-body ones first.
struct GivenModes {
  Eigen::VectorXd lambda;       ///< m, ascending [s^-2]
  Eigen::MatrixXd shapes;       ///< n×m, M-orthonormal
  Eigen::MatrixXd corrections;  ///< n×m: (K + sM)⁻¹(KΦ − MΦΛ)
  double shift = 0.0;           ///< s
  double bound = 0.0;           ///< [s^-2]
  Eigen::Index counted = 0;     ///< eigenvalues below the bound by the other program's inertia
};

/// The first modes of those given, as `modes` returns them. Nothing that can be computed without a
/// factor is believed: sizes, finite values, orthogonality, that the first modes are the rigid-body
/// motions, that the corrections solve their equation. Each residual is that of
/// fem/eigen/residual.h, from the correction. The modes are then refined by their corrections and
/// by Rayleigh-Ritz with KΦ in extended precision. What is believed is the number `counted`.
///
/// @param options  count, and nothing else
/// @throws InvalidInput      what is given cannot be what it should be (says which check)
/// @throws NumericalFailure  as `modes`; fewer or more modes below the bound than were counted;
///                           fewer than options.count
/// Cost: some 15 products with K per mode.
[[nodiscard]] ModesResult checked_modes(const System& system, const GivenModes& given,
                                        const ModesOptions& options = {});

}  // namespace chladni::fem
