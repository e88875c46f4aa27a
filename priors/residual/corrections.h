// A simulation with corrected stiffness and mass, and the likelihood of measured shapes with it.
#pragma once

#include <optional>

#include "priors/residual/residual_evidence.h"

namespace chladni::priors {

/// Modes of a simulation after corrections of its stiffness and mass, within the span of its r
/// modes (Rayleigh-Ritz).
struct CorrectedModes {
  Eigen::VectorXd frequency_hz;  ///< r, ascending; rigid-body modes exactly 0
  Eigen::MatrixXd turn;          ///< r×r: the shapes are Ψ · turn, mass-normalised
};

/// None if the corrected stiffness or mass is not positive. Cost: r² per correction, 20 r³.
/// @param parameters  per correction
[[nodiscard]] std::optional<CorrectedModes> corrected_modes(
    const Eigen::VectorXd& frequency_hz, const std::vector<Correction>& corrections,
    const Eigen::VectorXd& parameters);

/// The simulation's basis, and the measured places, expressed in the corrected modes.
[[nodiscard]] ModalBasis corrected_basis(const ModalBasis& basis, const CorrectedModes& modes);
[[nodiscard]] MeasuredShapes corrected_measured(const MeasuredShapes& measured,
                                                const CorrectedModes& modes);

/// pooled_evidence of the corrected simulation, with its slopes by ln η, ln κ, ln γ, ln noise
/// (first four) and by each parameter. The slopes are exact, also for repeated frequencies: the
/// prior depends only on the corrected stiffness and mass, not on the choice of their modes
/// (divided differences: Daleckii and Krein 1965). None if corrected_modes has none.
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
