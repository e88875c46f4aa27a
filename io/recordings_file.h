// Recordings in a file that is larger than the memory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/time_file.h"
#include "recordings/recordings.h"

namespace chladni::io {

struct RecordingsFile {
  std::string format;
  recordings::Recordings data;
  std::vector<std::string> notes;
};

/// Whether a file of recordings is read in pieces: a CSV of more than a quarter of the limit, a
/// universal file of more than a twentieth, or a .mat whose samples are more than a tenth, of which
/// the period is stated by the options or the file (in a CSV by a column). Blows of a hammer have
/// no period: such a file is read in pieces where the options say so. A file that is packed by gzip
/// counts as it is unpacked. Cost: a packed file is unpacked up to that size.
/// @throws InvalidInput  the line of the names, as parse_time_csv; a packed file that is damaged
[[nodiscard]] bool is_read_in_pieces(const std::filesystem::path& file,
                                     const TimeOptions& options = {});

/// Reads recordings, packed by gzip or not, with the checks and words of parse_time_csv,
/// parse_time_uff and time_of_mat. The samples go to a scratch file, of 8 bytes each, from which
/// they are taken as often as they are asked for; it goes with the last copy of `data`. Memory: of
/// a CSV 16 MB, or 65 536 rows where those need more; of a universal file its bytes, and one
/// channel of one record; of a .mat some parts of a sixty-fourth of the limit, or of 64 kB.
/// @throws InvalidInput    as these
/// @throws OutOfResources  no room for the scratch file
[[nodiscard]] RecordingsFile read_in_pieces(const std::filesystem::path& file,
                                            const TimeOptions& options = {});

/// As `read_in_pieces`, of a CSV whatever its ending.
[[nodiscard]] RecordingsFile read_csv_in_pieces(const std::filesystem::path& file,
                                                const TimeOptions& options = {});

}  // namespace chladni::io
