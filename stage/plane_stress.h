// Stiffness of a thin body against strains in its plane.
#pragma once

#include <Eigen/Core>

namespace chladni::stage {

/// Voigt index of the shear between two axes. The index of the strain along an axis is the axis.
[[nodiscard]] constexpr Eigen::Index shear_of(Eigen::Index u, Eigen::Index v) { return 6 - u - v; }

/// Constants of plane stress over two axes, 3×3 [Pa]: from strains uu, vv and uv to their stresses,
/// with zero stress out of the plane.
/// @param stiffness  in Voigt order xx yy zz yz xz xy [Pa]
[[nodiscard]] Eigen::Matrix3d plane_stress(const Eigen::Matrix<double, 6, 6>& stiffness,
                                           Eigen::Index u, Eigen::Index v);

}  // namespace chladni::stage
