// Smooth fields over the body and their effect on stiffness and mass.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// Smooth fields over the body: Legendre polynomials of u and v at the cells (columns, each of
/// largest value 1), in the order (1,0), (0,1), (2,0), (1,1), (0,2). Fields along a side that the
/// cells do not resolve are left out. b×5 or fewer.
[[nodiscard]] Eigen::MatrixXd smooth_fields(const BodyCells& cells);
/// Names of the fields of a face, in this order, and of those that the cells of a body resolve:
/// "v1" and "v2" for a line along v.
inline constexpr std::array<std::string_view, 5> kSmoothFields{"u1", "v1", "u2", "u1v1", "v2"};
[[nodiscard]] std::vector<std::string_view> names_of_smooth_fields(const BodyCells& cells);
/// The same fields at other places, n×2 [m].
[[nodiscard]] Eigen::MatrixXd smooth_fields(const BodyCells& cells, const Eigen::MatrixX2d& places);
/// Legendre polynomials of orders 3 to 6 along a body whose cells lie in one line: b×4. The line
/// then has 6 waves in all; a face has 5. b×0 on a face.
[[nodiscard]] Eigen::MatrixXd short_waves(const BodyCells& cells);

/// Σ_c weight_c A_c.
[[nodiscard]] Eigen::MatrixXd sum_of(const std::vector<Eigen::MatrixXd>& cells,
                                     const Eigen::VectorXd& weight);

/// Increase of K and M when the thickness of each cell is multiplied by 1 + field; r×r.
struct BodyChange {
  Eigen::MatrixXd stiffness, mass;
};
/// K_c goes as t³, except for transverse shear (as t). M_c goes as t, except for rotary inertia (as
/// t³). If the structure does not know these parts, K_c goes as t^bending_power.
[[nodiscard]] BodyChange thickened(const Structure& structure, const Eigen::VectorXd& field);
/// The same for field = smooth_fields times x: first order by BodyCells::Waves, the rest cell by
/// cell.
[[nodiscard]] BodyChange thickened_smoothly(const Structure& structure, const Eigen::VectorXd& x);
/// Derivative of thickened_smoothly by x_f, at x = 0.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure, Eigen::Index f);
/// Derivative of thickened by the amplitude of any field, which has one value per cell.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure, const Eigen::VectorXd& field);
/// The same derivative for a uniform field of 1.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure);
/// Increase of K when Young's modulus is multiplied by 1 + smooth_fields times x.
[[nodiscard]] Eigen::MatrixXd stiffened_smoothly(const Structure& structure,
                                                 const Eigen::VectorXd& x);

/// Adds the change of transverse shear and rotary inertia for t^bending_power − t in each cell,
/// beyond K as t^bending_power and M as t. Adds nothing if the structure does not know these parts.
void add_shear_and_turning(const Structure& structure, const Eigen::VectorXd& powered_less_linear,
                           Eigen::MatrixXd& stiffness, Eigen::MatrixXd& mass);

}  // namespace chladni::diagnosis
