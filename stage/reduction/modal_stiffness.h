// Effect of a change of elastic constants on the stiffness of the modes.
#pragma once

#include <functional>

#include "modal/modes.h"
#include "stage/model.h"

namespace chladni::stage {

/// Increase of a material's stiffness, in Voigt order xx yy zz yz xz xy [Pa]; may be indefinite.
using ElasticChange = std::function<Eigen::Matrix<double, 6, 6>(const fem::Material&)>;

/// Φᵀ ΔK Φ [s^-2] of shapes on the nodes, for the increase `change` of every material: m×m,
/// symmetric, rigid-body modes exactly stress-free. Linear in the change. Cost: fem::field_matrices
/// with one field.
[[nodiscard]] Eigen::MatrixXd modal_stiffness(const Model& model, const modal::Modes& modes,
                                              const ElasticChange& change);

/// `stiffness`, m×m on modes of these frequencies, made symmetric, without rounding errors on
/// rigid-body modes.
[[nodiscard]] Eigen::MatrixXd unstrained(Eigen::MatrixXd stiffness,
                                         const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::stage
