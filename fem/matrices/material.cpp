#include "fem/material.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/error.h"

namespace chladni::fem {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Row and column of the tensor for each entry of Voigt's order xx yy zz yz xz xy.
constexpr std::array<std::array<int, 2>, 6> kVoigt{
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

std::string text(double value) {
  std::array<char, 32> buffer{};
  (void)std::snprintf(buffer.data(), buffer.size(), "%.6g", value);
  return buffer.data();
}

void require_positive(double value, const std::string& name, const char* unit) {
  require(std::isfinite(value) && value > 0.0, "material: the " + name + " is " + text(value) +
                                                   " " + unit + "; expected a positive number");
}

void require_density(double density) { require_positive(density, "density", "kg/m^3"); }

// The matrix M with (σ in the body's axes) = M (σ in the material's axes), both in Voigt's order
// (Bond 1943; Auld 1973, section 3.D). Column j of M is R σ Rᵀ for unit stress j.
Matrix6 bond(const Eigen::Matrix3d& axes) {
  Matrix6 result;
  for (std::size_t j = 0; j < 6; ++j) {
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
    stress(kVoigt[j][0], kVoigt[j][1]) = stress(kVoigt[j][1], kVoigt[j][0]) = 1.0;
    const Eigen::Matrix3d seen = axes * stress * axes.transpose();
    for (std::size_t i = 0; i < 6; ++i) {
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          seen(kVoigt[i][0], kVoigt[i][1]);
    }
  }
  return result;
}

}  // namespace

Material isotropic(double youngs_modulus, double poissons_ratio, double density) {
  require_positive(youngs_modulus, "Young's modulus", "Pa");
  require(poissons_ratio > -1.0 && poissons_ratio < 0.5,
          "material: Poisson's ratio is " + text(poissons_ratio) +
              "; expected a number between -1 and 0.5 (0.33 for aluminium, 0.3 for steel)");
  require_density(density);
  const double shear = youngs_modulus / (2.0 * (1.0 + poissons_ratio));
  const double lame =
      youngs_modulus * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
  Material material{.stiffness = Matrix6::Zero(), .density = density};
  material.stiffness.topLeftCorner<3, 3>().setConstant(lame);
  material.stiffness.diagonal().head<3>().array() += 2.0 * shear;
  material.stiffness.diagonal().tail<3>().setConstant(shear);
  return material;
}

Material cubic(double c11, double c12, double c44, double density) {
  require(std::isfinite(c11) && std::isfinite(c12), "material: c11 = " + text(c11) + " Pa, c12 = " +
                                                        text(c12) + " Pa; expected finite numbers");
  // The eigenvalues of a cubic stiffness (Nye 1957, chapter VIII).
  require_positive(c11 - c12, "eigenvalue c11 - c12 of the cubic stiffness", "Pa");
  require_positive(c11 + 2.0 * c12, "eigenvalue c11 + 2 c12 of the cubic stiffness", "Pa");
  require_positive(c44, "eigenvalue c44 of the cubic stiffness", "Pa");
  require_density(density);
  Material material{.stiffness = Matrix6::Zero(), .density = density};
  material.stiffness.topLeftCorner<3, 3>().setConstant(c12);
  material.stiffness.diagonal().head<3>().setConstant(c11);
  material.stiffness.diagonal().tail<3>().setConstant(c44);
  return material;
}

Material orthotropic(const Orthotropic& constants, double density) {
  const auto& e = constants.youngs_modulus;
  const auto& nu = constants.poissons_ratio;
  const auto& g = constants.shear_modulus;
  const std::array<const char*, 3> shear_names{"G23", "G13", "G12"};
  for (int i = 0; i < 3; ++i) {
    require_positive(e(i), "Young's modulus E" + fmt::to_string(i + 1), "Pa");
    require_positive(g(i), std::string("shear modulus ") + shear_names[static_cast<std::size_t>(i)],
                     "Pa");
  }
  require(nu.allFinite(), "material: a Poisson's ratio is not finite");
  require_density(density);
  // Compliance of the normal stresses, made dimensionless with √(Ei Ej). Under a stress along i,
  // ν_ij = −ε_j / ε_i, so S_ij = −ν_ij / E_i = −ν_ji / E_j (Jones 1999, section 2.3).
  Eigen::Matrix3d compliance = Eigen::Matrix3d::Identity();
  compliance(0, 1) = compliance(1, 0) = -nu(2) * std::sqrt(e(1) / e(0));
  compliance(0, 2) = compliance(2, 0) = -nu(1) * std::sqrt(e(2) / e(0));
  compliance(1, 2) = compliance(2, 1) = -nu(0) * std::sqrt(e(2) / e(1));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(compliance);
  const double smallest = solver.eigenvalues()(0);
  require(smallest > 1e-12,
          "material: the orthotropic constants are not positive definite: the compliance of the "
          "normal stresses, scaled by the Young's moduli, has the eigenvalue " +
              text(smallest) +
              "; expected all positive: smaller Poisson's ratios (nu12 is the "
              "strain along 2 under a stress along 1; nu12 / E1 = nu21 / E2)");
  const Eigen::DiagonalMatrix<double, 3> scale(e.cwiseSqrt());
  Material material{.stiffness = Matrix6::Zero(), .density = density};
  material.stiffness.topLeftCorner<3, 3>() = scale * compliance.inverse() * scale;
  material.stiffness.diagonal().tail<3>() = g;
  return material;
}

Material turned(const Material& material, const Eigen::Matrix3d& axes) {
  require(axes.allFinite() && (axes.transpose() * axes).isIdentity(1e-9) && axes.determinant() > 0,
          "material: the axes are not a rotation; expected three orthogonal unit vectors, "
          "right-handed");
  const Matrix6 m = bond(axes);
  const Matrix6 stiffness = m * material.stiffness * m.transpose();
  return {.stiffness = 0.5 * (stiffness + stiffness.transpose()), .density = material.density};
}

}  // namespace chladni::fem
