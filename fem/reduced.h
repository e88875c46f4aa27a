// The model that every later step uses: modes at the channels and what the others leave there.
#pragma once

#include <vector>

#include "fem/system.h"
#include "modal/modes.h"
#include "modal/reduced_model.h"

namespace chladni::fem {

/// Rows on the nodes' displacements (mesh::row_at) as columns on the free degrees of freedom, n×k;
/// what lies on held ones is left out.
/// @throws InvalidInput  a row is longer than the degrees of freedom there are
[[nodiscard]] SparseMatrix columns_on_free(const DofMap& dofs,
                                           const std::vector<Eigen::SparseVector<double>>& rows);

/// C = D Dᵀ of a positive semidefinite matrix of low rank (lower triangle): n×rank, one column per
/// dashpot where they do not share degrees of freedom. Pivoted Cholesky; cost: entries·rank.
/// @throws InvalidInput  C is not positive semidefinite
[[nodiscard]] SparseMatrix dashpots(const SparseMatrix& damping);

/// Static response to forces of all modes that `modes` does not hold: x = Σ_{k not kept} φφᵀf / λ,
/// n×q [m] per [N]: K⁻¹f less its part in the modes, and for a free body in equilibrium with its
/// inertia ("inertia relief"; Craig and Kurdila 2006, section 17.3).
///
/// One factorisation of K + s M and some five solves: x is corrected by the residual of K x until
/// nothing changes, always orthogonal to the modes, where K is positive definite.
/// @throws InvalidInput      shapes do not fit, or the modes are not mass-orthonormal
/// @throws NumericalFailure  no convergence (modes missing below the last one)
[[nodiscard]] Eigen::MatrixXd residual_flexibility(const System& system, const modal::Modes& modes,
                                                   const SparseMatrix& forces);

/// The structure at p outputs and q inputs (columns on the free degrees of freedom), with its
/// dashpots. The static correction is exact: at frequencies far below the modes left out nothing is
/// missing, at f the error is of order (f / f_cut)² of the correction.
/// @throws as residual_flexibility
[[nodiscard]] modal::ReducedModel reduced(const System& system, const modal::Modes& modes,
                                          const SparseMatrix& outputs, const SparseMatrix& inputs);

}  // namespace chladni::fem
