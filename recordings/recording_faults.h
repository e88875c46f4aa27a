// What is wrong with recordings themselves: clipped channels, samples that were lost.
#pragma once

#include <string>
#include <vector>

#include "recordings/time_data.h"

namespace chladni::recordings {

struct RecordingFaults {
  /// One sentence per channel whose largest value occurs far more often than the next one.
  std::vector<std::string> clipped;
  /// One sentence per record of a periodic excitation whose periods do not repeat in place: from
  /// which period on, and by how many samples.
  std::vector<std::string> lost;
};

/// @throws InvalidInput  as check(const TimeData&)
/// Cost: one pass over the samples; transforms of the periods of the excitation.
[[nodiscard]] RecordingFaults recording_faults(const TimeData& data);

}  // namespace chladni::recordings
