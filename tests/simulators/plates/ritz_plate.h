// A free rectangular plate that bends and shears (Reissner 1945, Mindlin 1951), by the Ritz method.
// It is a truth that shares no code with fem/ and diagnosis/.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::simulators {

/// Plane-stress stiffnesses [Pa]: per area ½ t³/12 (q11 κx² + 2 q12 κx κy + q22 κy² + q66 κxy²)
/// with κxy = ψx,y + ψy,x, and ½ (5/6) t shear (γx² + γy²).
struct PlaneStiffness {
  double q11 = 0.0, q12 = 0.0, q22 = 0.0, q66 = 0.0, shear = 0.0;
};

/// q11 = q22 = E/(1 − ν²), q12 = ν q11, q66 = shear = E/(2 + 2ν).
[[nodiscard]] PlaneStiffness isotropic_plane(double youngs_modulus, double poisson);

/// A disc, as far as it lies on the plate, whose stiffness and mass per area are multiplied.
struct RitzDisc {
  Eigen::Vector2d centre;
  double radius = 0.0;  ///< [m]
  double stiffness = 1.0, mass = 1.0;
};

/// A straight band with less bending stiffness across it. `loss` (0 to 1) is the released fraction
/// of the moment about the band's line.
struct RitzCrack {
  Eigen::Vector2d from, to;  ///< [m]
  double width = 0.0;        ///< [m]
  double loss = 0.0;
};

/// A fixture of the body, such as a flexure or a coil. It follows the mean deflection and the mean
/// slopes of the surface within its footprint.
struct RitzFixture {
  Eigen::Vector2d place;
  double footprint = 0.0;                   ///< [m], diameter; 0: a point
  double mass = 0.0;                        ///< [kg]
  double inertia_x = 0.0, inertia_y = 0.0;  ///< [kg m²], of the slopes along x and along y
  double stiffness = 0.0;                   ///< [N/m], to the ground
  double turning_x = 0.0, turning_y = 0.0;  ///< [N m/rad], against the slopes along x and along y
};

/// A rectangular body centred at the origin, with sides along x and y. The defaults are empty; see
/// aluminium_table().
struct RitzBody {
  double length = 0.0, width = 0.0;  ///< along x and y [m]
  PlaneStiffness stiffness;
  double density = 0.0;       ///< [kg/m³]
  Eigen::MatrixXd thickness;  ///< [m]: entry (i, j) times P_i(2x/length) P_j(2y/width), Legendre's
  Eigen::MatrixXd modulus;    ///< in the same form, a factor of `stiffness`; 0×0: 1 everywhere
  std::vector<RitzDisc> discs;
  std::vector<RitzCrack> cracks;
  std::vector<RitzFixture> fixtures;
  int degree = 14;        ///< of the polynomials for w, ψx and ψy along each side
  int degree_across = 0;  ///< along y; 0: the same as `degree`

  [[nodiscard]] int degree_along_y() const { return degree_across > 0 ? degree_across : degree; }
  /// 3, or 0 where fixtures hold the body against lifting and against turning about both axes.
  /// @throws InvalidInput  they hold only some of these motions
  [[nodiscard]] Eigen::Index rigid_count() const;
};

/// 600×600×20 mm, 70 GPa, ν = 0.33, 2700 kg/m³: 19.44 kg.
[[nodiscard]] RitzBody aluminium_table(int degree = 14);

/// Whether the two bodies differ only by one scale factor of length and width.
[[nodiscard]] bool same_shape(const RitzBody& a, const RitzBody& b);

/// Matrices on n = 3 (degree + 1) (degree_along_y + 1) coefficients of w, ψx, ψy. The functions are
/// Legendre polynomials with a mean square of 1.
struct RitzMatrices {
  Eigen::MatrixXd stiffness, mass;
};
/// The matrices, exact for polynomial thickness and modulus. Discs, cracks and footprints are
/// integrated by the Gauss rule on their own areas. Cost: 0.1 s.
/// @throws InvalidInput  a size, a thickness or a modulus that is not positive, a disc or a fixture
///                       whose centre is off the plate, a stiffness that is not definite
[[nodiscard]] RitzMatrices ritz_matrices(const RitzBody& body);

/// All n modes of the body with its fixtures: rigid_count() rigid-body modes at exactly 0 Hz, then
/// the others, ascending. The upper half of the modes belongs to the basis, not to the plate.
struct RitzModes {
  RitzBody body;
  Eigen::VectorXd frequency_hz;  ///< n
  Eigen::MatrixXd coefficients;  ///< n×n, mass-normalised

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
};
/// The modes of a body. Cost: 0.5 s for degree 14, proportional to n³.
[[nodiscard]] RitzModes ritz_modes(const RitzBody& body);

/// w and its derivatives by the coefficients, at the rows of `places` (k×2 [m]).
struct RitzRows {
  Eigen::MatrixXd deflection, slope_x, slope_y;  ///< k×n; [1], [1/m], [1/m]
  Eigen::MatrixXd turn_x, turn_y;  ///< ψx, ψy: motion along x and y is z times these [1/m]
};
/// @throws InvalidInput  a place off the plate
[[nodiscard]] RitzRows ritz_rows(const RitzBody& body, const Eigen::MatrixX2d& places);

/// The rows in terms of the modes: k×n [kg^-1/2], [kg^-1/2 m^-1].
[[nodiscard]] RitzRows modal_rows(const RitzModes& modes, const Eigen::MatrixX2d& places);

/// w, ∂w/∂x and ∂w/∂y of the modes at one place, as columns: n×3. The same numbers as
/// `modal_rows` but for rounding, in a quarter of the time.
[[nodiscard]] Eigen::MatrixX3d deflection_at(const RitzModes& modes, const Eigen::Vector2d& place);

/// Parts of the stiffness. The parts sum to `all`.
enum class StiffnessPart { all, along_x, along_y, across, shear };

/// Φᵀ K_c Φ [s^-2] and Φᵀ M_c Φ of the rectangle [low, high] of the plate (without its discs and
/// cracks) for the first `count` modes. `part` selects the stiffness: along_x: q11, along_y: q22,
/// across: q12, shear: q66 and the transverse shear.
[[nodiscard]] RitzMatrices modal_cell(const RitzModes& modes, Eigen::Index count,
                                      const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                      StiffnessPart part = StiffnessPart::all);

}  // namespace chladni::simulators
