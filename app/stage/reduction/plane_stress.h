// What a thin body resists strains in its plane with.
#pragma once

#include <Eigen/Core>

namespace chladni::app {

/// Voigt's place of the shear between two axes; of the strain along an axis it is the axis.
[[nodiscard]] constexpr Eigen::Index shear_of(Eigen::Index u, Eigen::Index v) { return 6 - u - v; }

/// Constants of plane stress over two axes, 3×3 [Pa]: strains uu, vv and uv to their stresses, what
/// stands out of the plane being free.
/// @param stiffness  in Voigt order xx yy zz yz xz xy [Pa]
[[nodiscard]] Eigen::Matrix3d plane_stress(const Eigen::Matrix<double, 6, 6>& stiffness,
                                           Eigen::Index u, Eigen::Index v);

}  // namespace chladni::app
