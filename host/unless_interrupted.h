// Calls to the system that a signal may interrupt.
#pragma once

#include <sys/types.h>

#include <cerrno>

namespace chladni {

/// What a read or write gives, which is made again where a signal came between (EINTR).
template <typename Call>
[[nodiscard]] ssize_t unless_interrupted(const Call& call) {
  ssize_t count = 0;
  do count = call();
  while (count < 0 && errno == EINTR);
  return count;
}

}  // namespace chladni
