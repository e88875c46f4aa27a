// What is asked of modes before they are given out.
#pragma once

#include <string>
#include <vector>

#include "fem/system.h"

namespace chladni::fem {

/// Residuals (fem/eigen/residual.h) above which a mode is warned of, and those with which it is refused.
inline constexpr double kWorthAWarning = 1e-9;
inline constexpr double kNotTrusted = 1e-4;

/// What rounding of K alone makes of the energy φᵀKφ of shapes, 2.2e-16 |φ|ᵀ|K||φ|, without the
/// part of them along `known`, which costs what the springs say. [s^-2] for φᵀMφ = 1.
/// @param known  n×r, M-orthonormal; r may be 0. Cost: a product with K per shape.
[[nodiscard]] Eigen::VectorXd energy_rounding(const System& system, const Eigen::MatrixXd& known,
                                              const Eigen::MatrixXd& shapes);

/// A shape that costs no energy and is not among the rigid-body motions: a mechanism.
/// @param lambda  m; shapes n×m, M-orthonormal, M-orthogonal to system.rigid
/// @throws NumericalFailure  one costs no more than rounding (says where it moves most), or less
///                           than nothing: K is not positive semidefinite
void require_energy(const System& system, const Eigen::VectorXd& lambda,
                    const Eigen::MatrixXd& shapes);

/// "the mesh's stiffest motion has 1e+18 times this eigenvalue ...": what can be done where the
/// digits of K end, for the messages of failures at `lambda` [s^-2]; empty where they do not or it
/// is not known.
[[nodiscard]] std::string precision_advice(const System& system, double lambda);

/// Judges residuals, those of the rigid-body motions by their energy against that of the first
/// flexible mode.
/// @param lambda    m, flexible modes; residual m; shapes of the rigid ones are the system's
/// @return  a warning for the modes whose residual is above kWorthAWarning, if there are any
/// @throws NumericalFailure  a residual is kNotTrusted or more, or not a number
[[nodiscard]] std::vector<std::string> judged(const System& system, const Eigen::VectorXd& lambda,
                                              const Eigen::VectorXd& residual);

}  // namespace chladni::fem
