// The reduced model that every later step uses: the kept modes at the channels, and the static
// correction for the other modes.
#pragma once

#include <vector>

#include "fem/system.h"
#include "modal/modes.h"
#include "modal/reduced_model.h"

namespace chladni::fem {

/// Converts rows on the nodes' displacements (mesh::row_at) to columns on the free degrees of
/// freedom, n×k. Entries on held degrees of freedom are left out.
/// @throws InvalidInput  a row is longer than the number of degrees of freedom
[[nodiscard]] SparseMatrix columns_on_free(const DofMap& dofs,
                                           const std::vector<Eigen::SparseVector<double>>& rows);

/// The factor D (n×rank) of C = D Dᵀ, where C is a positive semidefinite matrix of low rank (lower
/// triangle). Where dashpots do not share degrees of freedom, each has one column. The method is
/// pivoted Cholesky; cost: entries·rank.
/// @throws InvalidInput  C is not positive semidefinite
[[nodiscard]] SparseMatrix dashpots(const SparseMatrix& damping);

/// Static response to `forces` of all modes that `modes` does not hold:
/// x = Σ_{k not kept} φφᵀf / λ, n×q [m] per [N]. This is K⁻¹f less its part in the modes. On a free
/// body the forces are in equilibrium with its inertia ("inertia relief"; Craig and Kurdila 2006,
/// section 17.3).
///
/// The method takes one factorisation of K + s M and about five solves. The residual of K x
/// corrects x until x no longer changes. x stays orthogonal to the modes, where K is positive
/// definite.
/// @throws InvalidInput      shapes do not fit, or the modes are not mass-orthonormal
/// @throws NumericalFailure  no convergence (modes missing below the last one)
[[nodiscard]] Eigen::MatrixXd residual_flexibility(const System& system, const modal::Modes& modes,
                                                   const SparseMatrix& forces);

/// The reduced model of the structure at p outputs and q inputs (columns on the free degrees of
/// freedom), with its dashpots. The static correction is exact at frequencies far below the omitted
/// modes. At f its error is of order (f / f_cut)² of the correction.
/// @throws as residual_flexibility
[[nodiscard]] modal::ReducedModel reduced(const System& system, const modal::Modes& modes,
                                          const SparseMatrix& outputs, const SparseMatrix& inputs);

}  // namespace chladni::fem
