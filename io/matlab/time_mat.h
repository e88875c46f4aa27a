// Recordings in .mat files.
#pragma once

#include <string>

#include "io/mat.h"
#include "io/time_file.h"

namespace chladni::io {

/// Reads recordings from variables: `y` (outputs), `u` (inputs) and, for a closed loop, `r`
/// (references), each samples×channels or samples×channels×records; `time_s` or `t` of one record,
/// or `sample_time_s`, `Ts`, `dt`; per record `experiment` and `realisation`; `period` [samples];
/// `output_names`, `output_unit`, `output_node`, `output_direction`, `output_position`, and the
/// same of `input` and `reference`.
/// @param name  of the file, for messages
/// @throws InvalidInput  names the variable, what was found and what was expected
[[nodiscard]] TimeFile time_of_mat(const MatFile& file, const std::string& name,
                                   const TimeOptions& options = {});

/// Variables that time_of_mat reads back to the last bit.
/// @throws InvalidInput  the records differ in length
[[nodiscard]] MatFields mat_of_time(const recordings::TimeData& data);

}  // namespace chladni::io
