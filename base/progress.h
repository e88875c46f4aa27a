// How a long step tells a person that it is alive.
#pragma once

#include <functional>
#include <string_view>

namespace chladni {

/// Called with what is being done and the fraction done in [0, 1], or −1 where it is not known.
/// May be empty: then nothing is told. Called from the thread that called the function.
using Progress = std::function<void(std::string_view step, double fraction)>;

inline void tell(const Progress& progress, std::string_view step, double fraction = -1.0) {
  if (progress) progress(step, fraction);
}

}  // namespace chladni
