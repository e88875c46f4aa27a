// The middle one of some values.
#pragma once

#include <algorithm>
#include <iterator>

namespace chladni {

/// The median; of an even number of values the larger one of the two in the middle. It changes
/// their order. Cost: linear. @pre there are some, and none is NaN
template <typename Values>
[[nodiscard]] auto upper_median(Values& values) {
  const auto middle = values.begin() + std::distance(values.begin(), values.end()) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace chladni
