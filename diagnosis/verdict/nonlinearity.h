// What random multisines say of a structure that is not linear.
#pragma once

#include <string>

#include "modal/frf_set.h"

namespace chladni::diagnosis {

/// What of the variance changes with the realisation of the excitation and not with the period: its
/// deviation over the responses, root mean squares over the channels of lines.
struct Nonlinearity {
  double share = 0.0;         ///< of the variance that noise does not explain, 0 to 1
  double level = 0.0;         ///< relative to the responses
  double strongest_hz = 0.0;  ///< middle of the eighth of the lines where it is largest,
  double strongest = 0.0;     ///< and its level there
};

/// Of responses that state both variances; all zero where they do not.
[[nodiscard]] Nonlinearity nonlinearity(const modal::FrfSet& measured);

/// A sentence where most of the variance is stochastic nonlinearity; else nothing.
[[nodiscard]] std::string nonlinearity_note(const modal::FrfSet& measured);

}  // namespace chladni::diagnosis
