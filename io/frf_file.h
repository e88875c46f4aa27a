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

enum class MatVersion;  // io/mat.h

/// The file is sound but holds no frequency responses (for example it holds recordings).
class NoResponses : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// As a unit: the values of each output are in the SI unit of its quantity, which the caller knows.
/// Outputs of several quantities have no unit in common.
inline constexpr const char* kEachInSi = "SI";

/// Information that a file of measured responses does not contain.
struct FrfOptions {
  /// Names of possible channels. They decide where "re_y1u1" is divided. Other names are read too.
  std::vector<std::string> sensor_names, actuator_names;
  /// Unit of the responses where the file states none: "mm", "m/s^2", "g", "um/V", kEachInSi.
  /// Empty: the numbers are taken as they are.
  std::string unit;
  std::optional<modal::FrfKind> kind;  ///< replaces the kind in the file, or a missing kind
  std::string length_unit;             ///< of a UFF file's coordinates without dataset 164
  std::vector<std::pair<std::string, std::string>> collocated;  ///< sensor, actuator
  std::size_t limit_bytes = reading_limit();                    ///< of memory for the content
};

struct FrfFile {
  std::string format;  ///< "CSV", "UFF 58b", "MAT 7.3"
  modal::FrfSet set;
  std::vector<std::string> notes;  ///< assumptions, skipped parts and suspicious data
};

/// Reads a file by its ending: .csv (.csv.gz), .uff .unv .uf, .mat. The page
/// docs/reference/measured_files.md describes the content of each. Values are in SI where units are
/// stated.
/// @throws InvalidInput  names file and place, what was found and what was expected
/// @throws NoResponses   there is no frequency response in the file
/// @throws WorkerDied    the program that reads .mat is missing
[[nodiscard]] FrfFile read_frf(const std::filesystem::path& file, const FrfOptions& options = {});

/// Writes a file by its ending: .csv, .uff .unv (58b, all digits), .mat.
/// @param version  of a .mat
/// @return  what the format cannot hold
/// @throws InvalidInput  another ending, or a name that the format cannot hold
[[nodiscard]] std::vector<std::string> write_frf(const std::filesystem::path& file,
                                                 const modal::FrfSet& set, MatVersion version = {});

/// Whether `file` has an ending of measured data.
[[nodiscard]] bool is_measured_file(const std::filesystem::path& file);

/// Reads the bytes of a CSV file. The first column is freq_hz. Then each response has columns re_,
/// im_ and optionally var_, noisevar_ and coh_, followed by the names of sensor and actuator, with
/// or without a / between them.
[[nodiscard]] FrfFile parse_frf_csv(std::string_view bytes, const std::string& name,
                                    const FrfOptions& options = {});

/// A CSV text that parse_frf_csv reads back to the last bit, except for units.
/// @throws InvalidInput  a name that a column cannot hold
[[nodiscard]] std::string frf_csv(const modal::FrfSet& set);

}  // namespace chladni::io
