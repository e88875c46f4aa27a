// What changes of a body's elastic constants add to the stiffness of its modes.
#pragma once

#include <functional>

#include "app/stage/model.h"
#include "modal/modes.h"

namespace chladni::app {

/// What a material's stiffness gains, in Voigt order xx yy zz yz xz xy [Pa]; need not be positive.
using ElasticChange = std::function<Eigen::Matrix<double, 6, 6>(const fem::Material&)>;

/// Φᵀ ΔK Φ [s^-2] of shapes on the nodes, where every material gains what `change` says of it: m×m,
/// symmetric, rigid-body modes stress-free exactly. Linear in the change. Cost: fem::field_matrices
/// with one field.
[[nodiscard]] Eigen::MatrixXd modal_stiffness(const Model& model, const modal::Modes& modes,
                                              const ElasticChange& change);

/// `stiffness`, m×m on modes of these frequencies, symmetric and without what rounding leaves on
/// rigid-body modes.
[[nodiscard]] Eigen::MatrixXd unstrained(Eigen::MatrixXd stiffness,
                                         const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::app
