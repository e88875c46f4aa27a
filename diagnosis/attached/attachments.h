// Attachments to the body, side by side, and their effect on the responses.
#pragma once

#include <complex>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// Returns k + c s + m s², or the dynamic stiffness of a carried mass.
[[nodiscard]] std::complex<double> dynamic_stiffness(const Attached& attached,
                                                     std::complex<double> s);

/// All attachments of a state together: D displacements.
struct Attachments {
  Eigen::MatrixXd shapes;                 ///< r×D
  Eigen::MatrixXd own;                    ///< D×D [m/N]: flexibility of the modes far above
  Eigen::MatrixXd to_outputs, to_inputs;  ///< p×D, q×D, likewise

  explicit Attachments(const State& state);
  [[nodiscard]] Eigen::Index count() const { return shapes.cols(); }
  [[nodiscard]] Eigen::VectorXcd stiffness(const State& state, std::complex<double> s) const;
};

/// Coupling on one line: Woodbury's identity applied to the body's own C Z⁻¹ and Z⁻¹ B.
struct Coupled {
  Eigen::MatrixXcd to_outputs, to_inputs;  ///< p×D, q×D: responses between them, with attachments
  Eigen::MatrixXcd direct;                 ///< p×q [m/N]: to be added to Cᵗ (Z⁻¹ B)
};

/// @param w  r×D: Z⁻¹ F of the body alone
/// @param left, right  (C Z⁻¹)ᵀ r×p and Z⁻¹ B r×q; of the body alone before, with attachments after
[[nodiscard]] Coupled couple(const Attachments& attachments, const State& state,
                             std::complex<double> s, const Eigen::MatrixXcd& w,
                             Eigen::Ref<Eigen::MatrixXcd> left, Eigen::Ref<Eigen::MatrixXcd> right);

}  // namespace chladni::diagnosis
