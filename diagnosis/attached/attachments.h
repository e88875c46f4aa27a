// What hangs on the body, side by side, and what it takes from the responses.
#pragma once

#include <complex>

#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// k + c s + m s², or of a carried mass.
[[nodiscard]] std::complex<double> dynamic_stiffness(const Attached& attached,
                                                     std::complex<double> s);

/// D displacements in all.
struct Attachments {
  Eigen::MatrixXd shapes;                 ///< r×D
  Eigen::MatrixXd own;                    ///< D×D [m/N]: flexibility of the modes far above
  Eigen::MatrixXd to_outputs, to_inputs;  ///< p×D, q×D, likewise

  explicit Attachments(const State& state);
  [[nodiscard]] Eigen::Index count() const { return shapes.cols(); }
  [[nodiscard]] Eigen::VectorXcd stiffness(const State& state, std::complex<double> s) const;
};

/// On one line: what Woodbury's identity makes of the body's own C Z⁻¹ and Z⁻¹ B.
struct Coupled {
  Eigen::MatrixXcd to_outputs, to_inputs;  ///< p×D, q×D: responses between, attachments included
  Eigen::MatrixXcd direct;                 ///< p×q [m/N]: to be added to Cᵗ (Z⁻¹ B)
};

/// @param w  r×D: Z⁻¹ F of the body alone
/// @param left, right  (C Z⁻¹)ᵀ r×p and Z⁻¹ B r×q of the body alone; with attachments afterwards
[[nodiscard]] Coupled couple(const Attachments& attachments, const State& state,
                             std::complex<double> s, const Eigen::MatrixXcd& w,
                             Eigen::Ref<Eigen::MatrixXcd> left, Eigen::Ref<Eigen::MatrixXcd> right);

}  // namespace chladni::diagnosis
