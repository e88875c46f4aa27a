// Universal files of recordings, where a test does not ask what they lose.
#pragma once

#include <string>
#include <vector>

#include "io/uff/time_uff.h"

namespace chladni::io {

inline std::string written_uff(const recordings::TimeData& data, UffEncoding encoding) {
  std::vector<std::string> lost;
  return time_uff(data, encoding, lost);
}

}  // namespace chladni::io
