// Recordings in universal files.
#pragma once

#include <string>
#include <string_view>

#include "io/time_file.h"
#include "io/uff/uff.h"

namespace chladni::io {

/// Time responses (dataset 58 of function type 1, or 0 over time). Inputs are what `options` lists
/// or forces by their type; load case is the experiment, version the realisation, and functions
/// of one channel in the same are further realisations.
/// @throws InvalidInput  as parse_uff; recordings of one experiment that differ in length or step
[[nodiscard]] TimeFile parse_time_uff(std::string_view bytes, const std::string& name,
                                      const TimeOptions& options = {});

/// In SI with 13 digits (text) or all of them (binary).
/// @throws InvalidInput  a name of more than 60 letters or with a line end
[[nodiscard]] std::string time_uff(const identification::TimeData& data, UffEncoding encoding);

}  // namespace chladni::io
