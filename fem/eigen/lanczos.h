// Block shift-invert Lanczos for K φ = λ M φ.
#pragma once

#include "base/progress.h"
#include "fem/factor/factorization.h"
#include "fem/system.h"

namespace chladni::fem {

struct LanczosOptions {
  int wanted = 20;
  int block = 4;
  double tolerance = 1e-10;  ///< on ‖r‖, r = (K − λM)φ after purification, relative to λ
  unsigned seed = 1;
};

struct LanczosResult {
  Eigen::VectorXd lambda;  ///< ascending; the wanted ones and all others that converged
  Eigen::MatrixXd shapes;  ///< n×m, M-orthonormal, M-orthogonal to `known`
  int block_steps = 0, solves = 0;
};

/// Number of basis vectors that `wanted` modes usually need. Where these are too few, the basis
/// grows by a quarter of its size at a time, if the memory is available.
[[nodiscard]] double lanczos_basis_size(int wanted, int block);

/// The `wanted` smallest eigenvalues of K φ = λ M φ besides those of `known`, and one more (or its
/// whole cluster), so that the gap above the last wanted one is known.
///
/// This is block Lanczos on (K + sM)⁻¹M in the M inner product. Each new block is orthogonalised
/// twice against all earlier vectors and against `known`, which are eigenvectors and are thereby
/// deflated. One more application purifies the Ritz vectors (Nour-Omid, Parlett, Ericsson and
/// Jensen 1987).
///
/// @param factor  of K + sM
/// @param known   n×r, M-orthonormal eigenvectors; r may be 0
/// @throws NumericalFailure  not converged with 600 + 8·wanted vectors
/// @throws OutOfResources    the basis must grow beyond lanczos_basis_size and cannot
/// @throws Interrupted
/// Source: Grimes, Lewis and Simon (1994), SIAM J. Matrix Anal. 15, 228-272.
[[nodiscard]] LanczosResult lanczos(const System& system, const Factorization& factor, double s,
                                    const Eigen::MatrixXd& known, const LanczosOptions& options,
                                    const Progress& progress = {});

}  // namespace chladni::fem
