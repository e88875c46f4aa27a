// Checks of the modes before they are returned.
#pragma once

#include <string>
#include <vector>

#include "fem/system.h"

namespace chladni::fem {

/// A mode whose residual (fem/eigen/residual.h) is above the first number gets a warning. A mode
/// with the second number or more is refused.
inline constexpr double kWorthAWarning = 1e-9;
inline constexpr double kNotTrusted = 1e-4;

/// The error of the energy φᵀKφ of each shape from rounding of K alone, 2.2e-16 |φ|ᵀ|K||φ|. The
/// shape's part along `known` is removed first, because its energy comes from the springs. [s^-2]
/// for φᵀMφ = 1.
/// @param known  n×r, M-orthonormal; r may be 0. Cost: a product with K per shape.
[[nodiscard]] Eigen::VectorXd energy_rounding(const System& system, const Eigen::MatrixXd& known,
                                              const Eigen::MatrixXd& shapes);

/// Refuses a mechanism: a shape that costs no energy and is not among the rigid-body motions.
/// @param lambda  m; shapes n×m, M-orthonormal, M-orthogonal to system.rigid
/// @throws NumericalFailure  the energy of a shape is no more than rounding (says where the shape
///                           moves most) or is negative (K is not positive semidefinite)
void require_energy(const System& system, const Eigen::VectorXd& lambda,
                    const Eigen::MatrixXd& shapes);

/// Advice for a failure at `lambda` [s^-2] where the digits of K are not enough: "the mesh's
/// stiffest motion has 1e+18 times this eigenvalue ...". Empty where the digits are enough or
/// `lambda` is not positive.
[[nodiscard]] std::string precision_advice(const System& system, double lambda);

/// Judges the residuals. A rigid-body motion is judged by its energy relative to the energy of the
/// first flexible mode.
/// @param lambda    m, flexible modes; residual m; the rigid-body shapes are system.rigid
/// @return  a warning for the modes whose residual is above kWorthAWarning, if there are any
/// @throws NumericalFailure  a residual is kNotTrusted or more, or not a number
[[nodiscard]] std::vector<std::string> judged(const System& system, const Eigen::VectorXd& lambda,
                                              const Eigen::VectorXd& residual);

}  // namespace chladni::fem
