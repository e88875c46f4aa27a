// A body that moves as a whole: its mass from responses above the suspension, its rows anywhere.
#pragma once

#include <Eigen/Core>

namespace chladni::identification {

/// What a rigid body can do: displacement along z at the places, r columns.
enum class RigidMotion {
  beam,   ///< [1 x]
  plate,  ///< [1 x y]
};

/// @param places  n×3 [m]; @returns n×r
[[nodiscard]] Eigen::MatrixXd rigid_directions(const Eigen::MatrixX3d& places, RigidMotion motion);

/// A mass matrix in the directions P that it was identified with: [1 x y] gives the mass [kg], the
/// mass times its centre [kg m] and the second moments [kg m²].
struct RigidBody {
  Eigen::MatrixXd mass, mass_std;  ///< r×r, symmetric
  /// r×r, T Tᵀ = mass⁻¹, upper triangular: P T are mass-normalised rigid-body shapes at any place.
  /// The first is the translation of the centre of mass, the next tilts along x about it, the last
  /// along y. Unlike principal axes they depend smoothly on the mass where inertias are alike.
  Eigen::MatrixXd modes;
  double asymmetry = 0.0;  ///< |A − Aᵀ| / |A + Aᵀ| of the inverse without the symmetry imposed; 0
                           ///< where the places cannot tell
  double misfit = 0.0;  ///< χ² per degree of freedom of the products about P_s M⁻¹ P_aᵀ; 0 where
                        ///< no deviation is given or nothing is left over
};

/// The factors L R of the 1/s² term are known up to an r×r matrix between them; the product is
/// not: L R = P_s M⁻¹ P_aᵀ, whatever way the modes were blended (thesis 5.2.5 and appendix C).
/// Weighted least squares on the symmetric M⁻¹. Cost: pq r⁴.
/// @param product    p×q [1/kg]: L_rb R_rb
/// @param deviation  p×q of its entries, or empty: all alike
/// @param outputs    p×r, P_s
/// @param inputs     q×r, P_a
/// @throws InvalidInput      sizes differ, a deviation is not positive, or the places do not
///                           determine the mass matrix
/// @throws NumericalFailure  M is not positive definite: a polarity or a place is wrong, or the
///                           modes are not those of a rigid body
[[nodiscard]] RigidBody rigid_body(const Eigen::MatrixXd& product, const Eigen::MatrixXd& deviation,
                                   const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs);

}  // namespace chladni::identification
