// Recordings in .mat files.
#pragma once

#include <functional>
#include <string>

#include "io/mat.h"
#include "io/recordings_file.h"
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

/// `count` numbers of a variable from `first` on.
using MatNumbers =
    std::function<Eigen::VectorXd(const MatValue& value, Eigen::Index first, Eigen::Index count)>;

/// As `time_of_mat`, of variables whose numbers may be left in the file.
/// @param file  it outlives the recordings, and so does what `numbers` reads
[[nodiscard]] RecordingsFile recordings_of_mat(const MatFile& file, const std::string& name,
                                               const TimeOptions& options,
                                               const MatNumbers& numbers);

/// Whether recordings of a .mat file would need more memory than there is for them as a whole, and
/// have periods, or the options ask for blows in pieces. Cost: of a large file, that of reading all
/// but its large variables.
[[nodiscard]] bool is_mat_read_in_pieces(const std::filesystem::path& file,
                                         const TimeOptions& options);

/// Reads such recordings; their samples go to a scratch file.
[[nodiscard]] RecordingsFile read_mat_in_pieces(const std::filesystem::path& file,
                                                const TimeOptions& options);

/// Variables that time_of_mat reads back to the last bit.
/// @throws InvalidInput  the records differ in length
[[nodiscard]] MatFields mat_of_time(const recordings::TimeData& data);

}  // namespace chladni::io
