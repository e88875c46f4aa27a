// What a simulation tells of the scale of a mode without a pair, with all that is doubtful of it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identification/gain_match.h"
#include "identification/gains/matched_sides.h"

namespace chladni::identification {

/// The gain that a simulation tells.
struct ToldByPrior {
  priors::GainMatch gain;
  std::size_t left_out = 0;  ///< simulations aside that tell no gain; its deviation lacks them
};

/// ln β of a mode at `frequency_hz` and its deviation: that of the evidence, and how far ln β moves
/// from the likeliest simulation to those aside of it. The sign and its certainty are those of the
/// likeliest simulation alone.
/// @throws NumericalFailure  one of the two sides sees nothing of the mode
[[nodiscard]] ToldByPrior told_by_prior(const TwoSides& sides, double frequency_hz,
                                        const GainPrior& prior);

/// What is doubtful of it, as sentences without the mode's name. @param aside  number of `aside`
[[nodiscard]] std::vector<std::string> doubts_of_told(const ToldByPrior& told, std::size_t aside);

/// Deviation of the values of one side, over their size, for a sign that is right with this
/// probability. 0 from Constants::sure_sign on: a band of 95 % leaves such a chance out.
[[nodiscard]] double deviation_of_sign(double certainty);

}  // namespace chladni::identification
