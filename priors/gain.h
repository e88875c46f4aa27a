// Gain of a mode between the sensor side and the actuator side, without a collocated pair.
#pragma once

#include "priors/dynamic_residual.h"
#include "priors/residual/residual_evidence.h"

namespace chladni::priors {

/// One identified mode: its values at s sensors and, by reciprocity, at a actuators. An
/// identification gives L = α φ at the sensors and R = φ/α at the actuators; α is unknown.
struct TwoSidedShape {
  double frequency_hz = 0.0;
  Places sensors, actuators;
  Eigen::VectorXd sensor_values, actuator_values;  ///< L, s; R, a
  Eigen::VectorXd sensor_noise, actuator_noise;    ///< standard deviations
};

/// ln β = 2 ln α: L divided by e^(ln β / 2) and R multiplied by it give one shape.
struct GainMatch {
  double log_gain = 0.0;      ///< mean of ln β
  double deviation = 0.0;     ///< standard deviation of ln β
  int sign = 1;               ///< −1: one side has the opposite polarity
  double certainty = 1.0;     ///< posterior probability of that sign
  double log_evidence = 0.0;  ///< at the most likely gain
};

/// The evidence of the gain under the dynamic residual's prior, over all sensors and actuators
/// together (instead of the thesis' 5.5, which needs a pair at one place): [L; R] ~ N(0, a² D K
/// D + Σ), D = diag(e^(ln β / 2), e^(−ln β / 2)), with the most likely a². A collocated pair counts
/// as one, since both its rows are equal. Cost: about 200 decompositions of s + a rows.
/// @throws InvalidInput  a side is empty, sizes differ, a noise is not positive
[[nodiscard]] GainMatch gain_match(const TwoSidedShape& shape, const ModalBasis& basis,
                                   const DynamicResidual& prior = {});

/// The most likely ln β under another simulation or other errors of it, for the sign of `near`, the
/// gain of a simulation near it. One step of Newton; where that is far or the evidence is nearly
/// straight (Constants::gain_move, gain_bend), the highest point about `near`.
/// @param near  its log_gain, deviation and sign are used
/// @throws NumericalFailure  the evidence has no peak there, or no finite value
/// Cost: 3 decompositions of s + a rows, with the highest point about 120.
[[nodiscard]] double log_gain_near(const TwoSidedShape& shape, const ModalBasis& basis,
                                   const DynamicResidual& prior, const GainMatch& near);

}  // namespace chladni::priors
