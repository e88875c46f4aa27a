// Recordings in universal files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/recordings_file.h"
#include "io/time_file.h"
#include "io/uff/uff.h"

namespace chladni::io {

/// Reads time responses (dataset 58 of function type 1, or of type 0 over time). Inputs are the
/// channels that `options` lists, and forces by their type. The load case is the experiment and the
/// version is the realisation. Further functions of a channel with the same numbers are further
/// realisations; all are numbered in order then. A name that the options have on two sides has the
/// side that the file says.
/// @throws InvalidInput  as parse_uff; or recordings of one experiment differ in length or step
[[nodiscard]] TimeFile parse_time_uff(std::string_view bytes, const std::string& name,
                                      const TimeOptions& options = {});

/// The same recordings, with the samples on the disk. Memory: the bytes, and one channel of one
/// recording.
/// @throws OutOfResources  no room for the scratch file
[[nodiscard]] RecordingsFile parse_time_uff_in_pieces(std::string_view bytes,
                                                      const std::string& name,
                                                      const TimeOptions& options = {});
/// Whether the begin of a file states a period, as time_uff writes it.
[[nodiscard]] bool states_period(std::string_view begin_of_file);

/// A universal file in SI with 13 digits (text) or all digits (binary). Adds to `lost`, in
/// sentences, what of the channels such a file does not hold.
/// @throws InvalidInput  a name has more than 60 letters or a line end
[[nodiscard]] std::string time_uff(const recordings::TimeData& data, UffEncoding encoding,
                                   std::vector<std::string>& lost);

}  // namespace chladni::io
