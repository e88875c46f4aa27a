// Natural vibrations of a body as a drum: functions ordered by how fast they vary along it.
#pragma once

#include <vector>

#include "mesh/laplacian.h"
#include "mesh/site.h"

namespace chladni::fem {

/// −Δ u_j = μ_j u_j, free at the rims; μ = 0 once for each connected piece.
struct LaplaceSpectrum {
  Eigen::VectorXd eigenvalue;  ///< h [1/m²], ascending
  Eigen::MatrixXd functions;  ///< nodes×h [1/m, on a body m^-3/2], ∫ u_i u_j = δ_ij; 0 where the
                              ///< operator is not known
};

/// The lowest `count` (a repeated one is not cut, so there may be more), none missing: by the
/// solver of modes.h. The error of μ is about μ h²/10 of it at cells of size h,
/// from above on flat faces.
/// @throws InvalidInput  fewer points than that; as modes()
[[nodiscard]] LaplaceSpectrum laplace_spectrum(const mesh::Laplacian& laplacian, int count);

/// The functions at places of the boundary, n×h.
/// @throws InvalidInput  a site's node is not one of the spectrum's
[[nodiscard]] Eigen::MatrixXd functions_at(const LaplaceSpectrum& spectrum,
                                           const std::vector<mesh::Site>& sites);

}  // namespace chladni::fem
