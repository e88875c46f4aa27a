// Learns corrections of a simulation's stiffness and mass from measured shapes and frequencies.
#pragma once

#include "priors/residual/corrections.h"

namespace chladni::priors {

/// A simulation after corrections.
struct CorrectedSimulation {
  CorrectedModes modes;
  ResidualErrors errors;  ///< of the corrected simulation
};

/// The most likely corrections, their uncertainty, and other plausible simulations.
struct LearnedCorrections {
  Eigen::VectorXd parameters;  ///< per correction
  Eigen::VectorXd deviation;   ///< per correction: its remaining uncertainty
  CorrectedSimulation likeliest;
  /// Simulations one posterior deviation away from the most likely one, along each principal
  /// direction of the covariance of γ and the corrections (Laplace's approximation). For any
  /// quantity, the sum of the squared differences from the most likely simulation is its variance.
  std::vector<CorrectedSimulation> aside;
  double log_evidence = 0.0;
  int evaluations = 0;
  std::vector<std::string> doubts;             ///< on the errors that are left
  std::vector<std::string> correction_doubts;  ///< on corrections far from plausible
};

/// The corrections and γ that are most likely under the measurement and their normal priors. The
/// rest of the error stays a dynamic residual: κ is about 1 (equal errors of stiffness and mass). η
/// lies between a third of its value without corrections and that value, since many corrections
/// could explain any frequency. The noise is that without corrections. The search starts with the
/// large η, where the evidence is smooth.
/// @throws InvalidInput  a correction that does not fit the modes or has no positive deviation
/// Cost: about 150 + 2 × corrections times corrected_evidence.
[[nodiscard]] LearnedCorrections learned_corrections(const MeasuredShapes& measured,
                                                     const ModalBasis& basis,
                                                     const std::vector<Correction>& corrections,
                                                     const ResidualPlausible& plausible = {});

}  // namespace chladni::priors
