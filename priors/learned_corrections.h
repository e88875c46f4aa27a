// What measured shapes and frequencies together say of a simulation's stiffness and mass.
#pragma once

#include "priors/residual/corrections.h"

namespace chladni::priors {

/// A simulation as it might be meant.
struct CorrectedSimulation {
  CorrectedModes modes;
  ResidualErrors errors;  ///< of the corrected simulation
};

/// The likeliest corrections, how well they are known, and simulations that are as good as theirs.
struct LearnedCorrections {
  Eigen::VectorXd parameters;  ///< per correction
  Eigen::VectorXd deviation;   ///< per correction: what is left of its uncertainty
  CorrectedSimulation likeliest;
  /// One posterior deviation away from the likeliest along each principal direction of what is
  /// known of γ and the corrections (Laplace's approximation): the sum of the squares of how
  /// anything differs in them from the likeliest is its variance.
  std::vector<CorrectedSimulation> aside;
  double log_evidence = 0.0;
  int evaluations = 0;
  std::vector<std::string> doubts;  ///< corrections that are far from what was thought
};

/// The corrections and γ that are likeliest under what is measured and their normal priors. What no
/// correction can say stays a dynamic residual: κ about 1 (what is left is of the stiffness as of
/// the mass), η at most that of the simulation without corrections and at least a third of it,
/// since many corrections would explain any frequency; the noise as without corrections. First
/// sought with the large η, whose evidence is smooth.
/// @throws InvalidInput  a correction that does not fit the modes or has no positive deviation
/// Cost: about 150 + 2 × corrections times corrected_evidence.
[[nodiscard]] LearnedCorrections learned_corrections(const MeasuredShapes& measured,
                                                     const ModalBasis& basis,
                                                     const std::vector<Correction>& corrections,
                                                     const ResidualPlausible& plausible = {});

}  // namespace chladni::priors
