// Limits of the memory for reading a file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "modal/frf_set.h"

namespace chladni::io {

/// Half of the available memory [bytes], read anew at each call. A fit needs the other half.
[[nodiscard]] std::size_t reading_limit();

/// Largest size of an unpacked text [bytes]. A growing string exists twice in memory.
[[nodiscard]] std::size_t text_limit(std::size_t limit);

/// Largest size of the numbers of a .mat file [bytes]. They exist in the worker and on their way
/// here, six times in all.
[[nodiscard]] std::size_t mat_limit(std::size_t limit);

/// @throws InvalidInput  `bytes` are more than the limit; the message says what needs them
void require_room(double bytes, std::size_t limit, const std::string& what);

/// Call this before `lines` of a set between its channels are allocated.
/// @param parts  number of arrays beside the responses: variances, coherence
/// @throws InvalidInput  they need more than the limit
void require_room(const modal::FrfSet& set, Eigen::Index lines, int parts, std::size_t limit);

/// The largest number of channels on one side. An array with more holds something else than
/// channels.
inline constexpr Eigen::Index kMostChannels = 100'000;
/// @throws InvalidInput  more than kMostChannels. @param side  "outputs"
void require_channels(Eigen::Index count, const std::string& side);

}  // namespace chladni::io
