// What a file of measured data can hold, asked before there are data.
#pragma once

#include <filesystem>
#include <vector>

#include "modal/frf_set.h"
#include "recordings/time_data.h"

namespace chladni::io {

/// Refuses what write_frf will refuse to write.
/// @param outputs, inputs  channels with their names; one or more of each
/// @throws InvalidInput    another ending, or a name that the format of `file` cannot hold
void require_writable_frf(const std::filesystem::path& file,
                          const std::vector<modal::MeasuredChannel>& outputs,
                          const std::vector<modal::MeasuredChannel>& inputs);

/// Refuses what write_time will refuse to write of these channels, whatever their samples.
/// @param data           channels with their names; records are not looked at
/// @throws InvalidInput  another ending, or a name that the format of `file` cannot hold
void require_writable_time(const std::filesystem::path& file, recordings::TimeData data);

}  // namespace chladni::io
