// The memory that reading a file may take.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "modal/frf_set.h"

namespace chladni::io {

/// Half of the memory that there is [bytes], asked anew at each call: a fit needs the rest.
[[nodiscard]] std::size_t reading_limit();

/// What a text may be unpacked to [bytes]: while a string grows, it is there twice.
[[nodiscard]] std::size_t text_limit(std::size_t limit);

/// What the numbers of a .mat file may be [bytes]: they are there in the worker and on their way
/// here, six times in all.
[[nodiscard]] std::size_t mat_limit(std::size_t limit);

/// @throws InvalidInput  `bytes` are more than the limit: says what needs them
void require_room(double bytes, std::size_t limit, const std::string& what);

/// Before `lines` of a set between its channels are allocated. @param parts  arrays of numbers
/// beside the responses: variances, coherence
/// @throws InvalidInput  they need more than the limit
void require_room(const modal::FrfSet& set, Eigen::Index lines, int parts, std::size_t limit);

/// More channels on one side than any rig has are an array that is something else.
inline constexpr Eigen::Index kMostChannels = 100'000;
/// @throws InvalidInput  more than that. @param side  "outputs"
void require_channels(Eigen::Index count, const std::string& side);

}  // namespace chladni::io
