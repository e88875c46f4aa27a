// A thin plate that shares no code with fem/. It is an independent truth for tests.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::simulators {

/// A rectangle of nx×ny equal cells, centred at the origin, x fastest.
struct PlateGrid {
  double length = 0.6, width = 0.6;  ///< along x and y [m]
  int nx = 20, ny = 20;

  [[nodiscard]] Eigen::Index cell_count() const { return Eigen::Index{nx} * ny; }
  [[nodiscard]] Eigen::Index node_count() const { return Eigen::Index{nx + 1} * (ny + 1); }
  [[nodiscard]] double cell_area() const { return length / nx * width / ny; }
  [[nodiscard]] Eigen::Vector2d centre(Eigen::Index cell) const;  ///< [m]
};

/// Energy per area ½ (d11 wxx² + 2 d12 wxx wyy + d22 wyy² + 4 d66 wxy²) [N m].
struct BendingStiffness {
  double d11 = 0.0, d12 = 0.0, d22 = 0.0, d66 = 0.0;
};

/// d11 = d22 = d, d12 = ν d, d66 = (1 − ν) d / 2.
[[nodiscard]] BendingStiffness isotropic_bending(double d, double poisson);

struct PointMass {
  Eigen::Vector2d place;  ///< [m]
  double kg = 0.0;
};

/// A plate that is free on all sides.
struct KirchhoffPlate {
  PlateGrid grid;
  std::vector<BendingStiffness> bending;  ///< per cell
  Eigen::VectorXd areal_mass;             ///< per cell [kg/m²]; 0: the cell is cut out
  std::vector<PointMass> masses;          ///< at places of the plate
};

[[nodiscard]] KirchhoffPlate uniform_plate(const PlateGrid& grid, const BendingStiffness& bending,
                                           double areal_mass);

/// Three rigid-body modes (spanning 1, x, y; 0 Hz), then the flexible ones, ascending.
struct PlateModes {
  PlateGrid grid;
  std::vector<char> present;     ///< per cell
  Eigen::VectorXd frequency_hz;  ///< m
  Eigen::MatrixXd dofs;  ///< 4·nodes×m [kg^-1/2]: w, hx wx, hy wy, hx hy wxy; 0 off the plate

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
};

/// Mass-normalised modes with C1 bicubic Hermite elements (Bogner, Fox and Schmit 1965), by block
/// Lanczos on (K + sM)⁻¹M with full orthogonalisation. Frequencies converge as h⁴ where the plate
/// is smooth. Cost: 20×20 cells and 15 modes well below 0.3 s.
/// @throws InvalidInput      arrays that do not fit the grid, a value that is not positive, cells
///                           in several pieces, a mass off the plate, more modes than possible
/// @throws NumericalFailure  the iteration did not converge
[[nodiscard]] PlateModes plate_modes(const KirchhoffPlate& plate, int flexible);

/// Φᵀ K_f Φ [s^-2] and Φᵀ M_f Φ for each field f. K_f and M_f are the matrices of the plate without
/// its point masses, with bending and areal mass multiplied by the field. A field of ones gives
/// diag λ.
struct PlateFieldMatrices {
  std::vector<Eigen::MatrixXd> stiffness, mass;
};
/// @param fields  cells×F; @throws InvalidInput  the fields do not fit the plate
[[nodiscard]] PlateFieldMatrices plate_field_matrices(const KirchhoffPlate& plate,
                                                      const PlateModes& modes,
                                                      const Eigen::MatrixXd& fields);

/// Whether (x, y) lies on an existing cell or its rim.
[[nodiscard]] bool covers(const PlateModes& modes, const Eigen::Vector2d& place);

/// n×m: the shapes at the rows of `places` (n×2 [m]), by the elements' own shape functions.
/// @throws InvalidInput  a place is not on the plate
[[nodiscard]] Eigen::MatrixXd shapes_at(const PlateModes& modes, const Eigen::MatrixX2d& places);

/// Gauss points of the existing cells (n×2), and the area of each point.
struct PlateSurface {
  Eigen::MatrixX2d places;
  Eigen::VectorXd area;  ///< [m²]
};
/// @param per_side  points per cell and direction, 1 or 2
[[nodiscard]] PlateSurface plate_surface(const PlateModes& modes, int per_side = 1);

}  // namespace chladni::simulators
