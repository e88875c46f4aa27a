// Fields over the body and what they make of its stiffness and mass.
#pragma once

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// Smooth fields over the body, Legendre's polynomials of u and v over the cells (columns, each of
/// largest value 1): (1,0), (0,1), (2,0), (1,1), (0,2); without those along a side that the cells
/// do not resolve. b×5 or fewer.
[[nodiscard]] Eigen::MatrixXd smooth_fields(const BodyCells& cells);
/// The same at other places, n×2 [m].
[[nodiscard]] Eigen::MatrixXd smooth_fields(const BodyCells& cells, const Eigen::MatrixX2d& places);
/// Along a body whose cells lie in one line, Legendre's polynomials of third to sixth order: b×4,
/// so that it has as many waves as a face; b×0 on a face.
[[nodiscard]] Eigen::MatrixXd short_waves(const BodyCells& cells);

/// Σ_c weight_c A_c.
[[nodiscard]] Eigen::MatrixXd sum_of(const std::vector<Eigen::MatrixXd>& cells,
                                     const Eigen::VectorXd& weight);

/// What a body gains when its thickness becomes 1 + field times what it was, cell by cell; r×r.
struct BodyChange {
  Eigen::MatrixXd stiffness, mass;
};
/// K_c as t³ but for transverse shear (t), M_c as t but for rotary inertia (t³), where the
/// structure knows these parts; K_c as t^bending_power where it does not.
[[nodiscard]] BodyChange thickened(const Structure& structure, const Eigen::VectorXd& field);
/// Of smooth_fields times x: to first order by BodyCells::Waves, the rest cell by cell.
[[nodiscard]] BodyChange thickened_smoothly(const Structure& structure, const Eigen::VectorXd& x);
/// Its derivative by x_f, at 0.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure, Eigen::Index f);
/// Its derivative by the size of any field, a value per cell.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure, const Eigen::VectorXd& field);
/// The same of the whole body at once.
[[nodiscard]] BodyChange thickness_slope(const Structure& structure);
/// What K gains when Young's modulus becomes 1 + smooth_fields times x.
[[nodiscard]] Eigen::MatrixXd stiffened_smoothly(const Structure& structure,
                                                 const Eigen::VectorXd& x);

/// What t^bending_power − t, cell by cell, changes in K and M beyond K as t^bending_power and M
/// as t: transverse shear and rotary inertia; nothing where the structure does not know them.
void add_shear_and_turning(const Structure& structure, const Eigen::VectorXd& powered_less_linear,
                           Eigen::MatrixXd& stiffness, Eigen::MatrixXd& mass);

}  // namespace chladni::diagnosis
