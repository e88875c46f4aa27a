// Eigenfunctions of the Laplacian on a body (a drum), ordered by how fast they vary along the body.
#pragma once

#include <vector>

#include "mesh/laplacian.h"
#include "mesh/site.h"

namespace chladni::fem {

/// The solutions of −Δ u_j = μ_j u_j, free at the rims. μ = 0 occurs once for each connected piece.
struct LaplaceSpectrum {
  Eigen::VectorXd eigenvalue;  ///< h [1/m²], ascending
  Eigen::MatrixXd functions;  ///< nodes×h [1/m, on a body m^-3/2], ∫ u_i u_j = δ_ij; 0 where the
                              ///< operator is not known
};

/// The lowest `count` eigenpairs from the solver of modes.h; none is missing. A cluster of repeated
/// values is not cut, so there may be more. The relative error of μ is about μ h²/10 at cells of
/// size h; on flat faces μ is too high.
/// @throws InvalidInput  there are fewer points than `count`; as modes()
[[nodiscard]] LaplaceSpectrum laplace_spectrum(const mesh::Laplacian& laplacian, int count);

/// The functions at n sites of the boundary, n×h.
/// @throws InvalidInput  a site's node is not one of the spectrum's
[[nodiscard]] Eigen::MatrixXd functions_at(const LaplaceSpectrum& spectrum,
                                           const std::vector<mesh::Site>& sites);

}  // namespace chladni::fem
