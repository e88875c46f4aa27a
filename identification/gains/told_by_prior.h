// What a simulation tells of the scale of a mode without a pair, with all that is doubtful of it.
#pragma once

#include "identification/gain_match.h"
#include "identification/gains/matched_sides.h"

namespace chladni::identification {

/// ln β of a mode at `frequency_hz` and its deviation: that of the evidence, and how far ln β moves
/// from the likeliest simulation to those aside of it.
/// @throws NumericalFailure  one of the two sides sees nothing of the mode
[[nodiscard]] priors::GainMatch told_by_prior(const TwoSides& sides, double frequency_hz,
                                              const GainPrior& prior);

/// Deviation of the values of one side, over their size, for a sign that is right with this
/// probability. 0 from Constants::sure_sign on: a band of 95 % leaves such a chance out.
[[nodiscard]] double deviation_of_sign(double certainty);

}  // namespace chladni::identification
