// Linear elastic materials.
#pragma once

#include <Eigen/Core>
#include <string>

namespace chladni::fem {

/// Stiffness in Voigt order xx yy zz yz xz xy (engineering shear), in the body's axes.
struct Material {
  Eigen::Matrix<double, 6, 6> stiffness;  ///< [Pa], symmetric, positive definite
  double density = 0.0;                   ///< [kg/m^3]
};

struct Orthotropic {
  Eigen::Vector3d youngs_modulus;  ///< E1 E2 E3 [Pa]
  Eigen::Vector3d poissons_ratio;  ///< nu23 nu13 nu12: nu_ij is the strain along j under a stress
                                   ///< along i, with its sign turned; nu12 / E1 = nu21 / E2
  Eigen::Vector3d shear_modulus;   ///< G23 G13 G12 [Pa]
};

/// @throws InvalidInput  E <= 0, nu outside (−1, 0.5), density <= 0, or not finite
[[nodiscard]] Material isotropic(double youngs_modulus, double poissons_ratio, double density);
/// Cubic crystal such as silicon (c11 165.7, c12 63.9, c44 79.6 GPa), axes along the body's.
/// @throws InvalidInput  not positive definite
[[nodiscard]] Material cubic(double c11, double c12, double c44, double density);
/// @throws InvalidInput  not positive definite (names the eigenvalue)
[[nodiscard]] Material orthotropic(const Orthotropic& constants, double density);
/// The same material with its axes turned: column k of `axes` is its k-th axis in the body's frame.
/// @throws InvalidInput  axes is not a rotation
[[nodiscard]] Material turned(const Material& material, const Eigen::Matrix3d& axes);

}  // namespace chladni::fem
