// Whether a set of responses says how exact it is.
#pragma once

#include <algorithm>

#include "modal/frf_set.h"

namespace chladni::modal {

/// True if a variance above 0 stands in the set: zeros state none.
[[nodiscard]] inline bool states_variances(const FrfSet& set) {
  return std::ranges::any_of(set.variance,
                             [](const auto& line) { return (line.array() > 0.0).any(); });
}

}  // namespace chladni::modal
