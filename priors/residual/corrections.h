// A simulation whose stiffness and mass are corrected, and how likely that makes measured shapes.
#pragma once

#include <optional>

#include "priors/residual/residual_evidence.h"

namespace chladni::priors {

/// A simulation's modes once corrections have been added to its stiffness and mass, within the span
/// of the r modes that it had (Rayleigh-Ritz).
struct CorrectedModes {
  Eigen::VectorXd frequency_hz;  ///< r, ascending; rigid-body modes exactly 0
  Eigen::MatrixXd turn;          ///< r×r: the shapes are Ψ · turn, mass-normalised
};

/// None where the corrected stiffness or mass is not positive. Cost: r² per correction, 20 r³.
/// @param parameters  per correction
[[nodiscard]] std::optional<CorrectedModes> corrected_modes(
    const Eigen::VectorXd& frequency_hz, const std::vector<Correction>& corrections,
    const Eigen::VectorXd& parameters);

/// The simulation's basis, and the measured places, told on the corrected modes.
[[nodiscard]] ModalBasis corrected_basis(const ModalBasis& basis, const CorrectedModes& modes);
[[nodiscard]] MeasuredShapes corrected_measured(const MeasuredShapes& measured,
                                                const CorrectedModes& modes);

/// pooled_evidence of the corrected simulation, and its slopes with ln η, ln κ, ln γ, ln noise
/// (first four) and with each parameter; exact, also where frequencies are repeated, since the
/// prior depends on the corrected stiffness and mass alone, not on how their modes are chosen
/// (divided differences: Daleckii and Krein 1965). None where corrected_modes has none.
/// Cost: that of pooled_evidence and of corrected_modes, and 3 r³.
struct CorrectedEvidence {
  double log_evidence = 0.0;
  Eigen::VectorXd slopes;  ///< 4 + corrections
};
[[nodiscard]] std::optional<CorrectedEvidence> corrected_evidence(
    const MeasuredShapes& measured, const ModalBasis& basis,
    const std::vector<Correction>& corrections, const ResidualErrors& errors,
    const Eigen::VectorXd& parameters);

}  // namespace chladni::priors
