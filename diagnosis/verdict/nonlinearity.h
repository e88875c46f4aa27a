// Evidence of nonlinearity in measurements with random multisines.
#pragma once

#include <string>

#include "modal/frf_set.h"

namespace chladni::diagnosis {

/// The part of the variance that changes with the realisation of the excitation and not with the
/// period: its standard deviation over the responses, root mean squares over the channels of lines.
struct Nonlinearity {
  double share = 0.0;         ///< part of the variance that is not noise, 0 to 1
  double level = 0.0;         ///< relative to the responses
  double strongest_hz = 0.0;  ///< middle of the eighth of the lines with the highest level
  double strongest = 0.0;     ///< the level there
};

/// Needs responses that state both variances; all zero otherwise.
[[nodiscard]] Nonlinearity nonlinearity(const modal::FrfSet& measured);

/// A sentence if most of the variance is stochastic nonlinearity; else empty.
[[nodiscard]] std::string nonlinearity_note(const modal::FrfSet& measured);

}  // namespace chladni::diagnosis
