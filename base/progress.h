// Progress reports of long steps.
#pragma once

#include <functional>
#include <string_view>

namespace chladni {

/// Gets the current step and the fraction done in [0, 1], or −1: not known. It may be empty. It
/// runs in the thread that called the long function; in a sweep in several, one call at a time.
using Progress = std::function<void(std::string_view step, double fraction)>;

inline void tell(const Progress& progress, std::string_view step, double fraction = -1.0) {
  if (progress) progress(step, fraction);
}

}  // namespace chladni
