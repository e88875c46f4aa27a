// A rigid body: its mass from responses above the suspension, and its shape rows at any place.
#pragma once

#include <Eigen/Core>

namespace chladni::identification {

/// Possible motions of a rigid body: displacement along z at the places, r columns.
enum class RigidMotion {
  beam,   ///< [1 x]
  plate,  ///< [1 x y]
};

/// @param places  n×3 [m]; @returns n×r
[[nodiscard]] Eigen::MatrixXd rigid_directions(const Eigen::MatrixX3d& places, RigidMotion motion);

/// A mass matrix in the directions P of its identification: [1 x y] gives the mass [kg], the mass
/// times its centre [kg m] and the second moments [kg m²].
struct RigidBody {
  Eigen::MatrixXd mass, mass_std;  ///< r×r, symmetric
  /// r×r, T Tᵀ = mass⁻¹, upper triangular: P T are mass-normalised rigid-body shapes at any place.
  /// The first is the translation of the centre of mass, the second tilts along x about this
  /// centre, the last along y. Unlike principal axes they depend smoothly on the mass where
  /// inertias are equal.
  Eigen::MatrixXd modes;
  /// Covariance of the r(r+1)/2 entries of mass⁻¹, the lower triangle column by column; empty if
  /// not known, infinite where a body near this one has no mass.
  Eigen::MatrixXd inverse_covariance = {};
  double asymmetry = 0.0;  ///< |A − Aᵀ| / |A + Aᵀ| of the inverse mass without imposed symmetry; 0
                           ///< if the places do not determine it
  double misfit = 0.0;  ///< χ² per degree of freedom of the products about P_s M⁻¹ P_aᵀ; 0 without
                        ///< deviations or without degrees of freedom
};

/// The entries of a symmetric matrix, the lower triangle column by column: r(r+1)/2.
[[nodiscard]] Eigen::VectorXd lower_entries(const Eigen::MatrixXd& symmetric);

/// The factors L R of the 1/s² term are known up to an r×r matrix between them. Their product is
/// known: L R = P_s M⁻¹ P_aᵀ, however the modes are mixed (thesis 5.2.5 and appendix C). Weighted
/// least squares give the symmetric M⁻¹, without its covariance. Cost: pq r⁴.
/// @param product    p×q [1/kg]: L_rb R_rb
/// @param deviation  p×q of its entries; empty: all equal
/// @param outputs    p×r, P_s
/// @param inputs     q×r, P_a
/// @throws InvalidInput      sizes differ, or a deviation is not positive
/// @throws NumericalFailure  the places do not determine the mass matrix, or M is not positive
///                           definite: a polarity or a place is wrong, or the modes are not those
///                           of a rigid body
[[nodiscard]] RigidBody rigid_body(const Eigen::MatrixXd& product, const Eigen::MatrixXd& deviation,
                                   const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs);

}  // namespace chladni::identification
