// Measured frequency responses in files: CSV, universal files (UFF), MAT.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/bytes/room.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// A sound file that holds something else than frequency responses, recordings for one.
class NoResponses : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// What a file of measured responses does not say itself.
struct FrfOptions {
  /// Channels that may occur: they tell where "re_y1u1" is to be cut. Others are read too.
  std::vector<std::string> sensor_names, actuator_names;
  /// In which the responses are where the file does not say: "mm", "m/s^2", "g", "um/V"; empty:
  /// as they stand.
  std::string unit;
  std::optional<modal::FrfKind> kind;  ///< overrules what the file says or does not say
  std::string length_unit;             ///< of a UFF file's coordinates without dataset 164
  std::vector<std::pair<std::string, std::string>> collocated;  ///< sensor, actuator
  std::size_t limit_bytes = reading_limit();                    ///< of memory for what it holds
};

struct FrfFile {
  std::string format;  ///< "CSV", "UFF 58b", "MAT 7.3"
  modal::FrfSet set;
  std::vector<std::string> notes;  ///< what was assumed, passed over or is suspect
};

/// By its ending: .csv (.csv.gz), .uff .unv .uf, .mat. docs/reference/measured_files.md has what
/// each may hold. Values are SI where units are stated.
/// @throws InvalidInput  names file and place, what was found and what was expected
/// @throws NoResponses   there is no frequency response in it
/// @throws WorkerDied    the program that reads .mat is missing
[[nodiscard]] FrfFile read_frf(const std::filesystem::path& file, const FrfOptions& options = {});

/// By its ending: .csv, .uff .unv (58b, all digits), .mat (v5). @return what the format cannot hold
/// @throws InvalidInput  another ending, or a name that the format cannot hold
[[nodiscard]] std::vector<std::string> write_frf(const std::filesystem::path& file,
                                                 const modal::FrfSet& set);

/// Whether `file` ends as one of measured data.
[[nodiscard]] bool is_measured_file(const std::filesystem::path& file);

/// The bytes of a CSV file: a first column freq_hz, then re_, im_ and optionally var_, noisevar_
/// and coh_ of each response, named sensor, actuator, with or without / between them.
[[nodiscard]] FrfFile parse_frf_csv(std::string_view bytes, const std::string& name,
                                    const FrfOptions& options = {});

/// What parse_frf_csv reads back to the last bit, units aside.
/// @throws InvalidInput  a name that a column cannot hold
[[nodiscard]] std::string frf_csv(const modal::FrfSet& set);

}  // namespace chladni::io
