// Flexible modes on their way from an eigensolver to the result.
#pragma once

#include "fem/given_modes.h"
#include "fem/system.h"

namespace chladni::fem {

/// Flexible modes with their residuals (fem/eigen/residual.h).
struct Found {
  Eigen::VectorXd lambda;    ///< m, ascending [s^-2]
  Eigen::VectorXd residual;  ///< m, relative
  Eigen::MatrixXd shapes;    ///< n×m, M-orthonormal and M-orthogonal to the rigid-body motions
};

/// `count`, raised so that the cluster of the last mode is not cut.
[[nodiscard]] Eigen::Index uncut(const Eigen::VectorXd& lambda, Eigen::Index count);

/// Orients repeated modes. Each mode of a cluster then gets the combined residual of the cluster.
void settle(const System& system, Found& found);

/// The rigid-body motions, n×r. In a system without any, system.rigid may be 0×0.
[[nodiscard]] Eigen::MatrixXd rigid_motions(const System& system);

/// The columns of both.
[[nodiscard]] Eigen::MatrixXd beside(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right);

/// The rigid-body modes and the first `kept` of those found, judged.
/// @throws NumericalFailure  a residual is 1e-4 or more; max |ΦᵀMΦ − I| is 1e-8 or more
[[nodiscard]] ModesResult assembled(const System& system, const Found& found, Eigen::Index kept,
                                    ModesSummary summary);

}  // namespace chladni::fem
