// The lowest eigenpairs of a small sparse pencil, for simulators that share no code with fem/.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace chladni::simulators {

/// K φ = λ M φ of n degrees of freedom.
struct Pencil {
  Eigen::SparseMatrix<double> stiffness, mass;  ///< lower triangles; M positive definite
  Eigen::MatrixXd rigid;                        ///< n×r: K times these is 0
};

struct LowestModes {
  Eigen::VectorXd lambda;  ///< r zeros, then ascending
  Eigen::MatrixXd shapes;  ///< n×(r + count), M-orthonormal
};

/// Block Lanczos on (K + sM)⁻¹M with full orthogonalisation. Repeated eigenvalues are found up to
/// the block size, 6.
/// @param s  about the lowest eigenvalue that is not 0
/// @throws InvalidInput      fewer than `count` eigenvectors beside the rigid ones
/// @throws NumericalFailure  M is not positive definite; no convergence
[[nodiscard]] LowestModes lowest_modes(const Pencil& pencil, int count, double s);

}  // namespace chladni::simulators
