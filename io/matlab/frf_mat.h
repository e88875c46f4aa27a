// Measured responses in .mat files.
#pragma once

#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/mat.h"

namespace chladni::io {

/// What the variable `dimensions` says where the sizes of the responses leave it open.
inline constexpr const char* kLinesFirst = "lines x outputs x inputs";
inline constexpr const char* kLinesLast = "outputs x inputs x lines";

/// Reads the responses from variables. Frequencies are `freq_hz`, `frequency_hz`, `frequency`,
/// `freq`, `f`, or `w` and `omega` in rad/s. Responses are `H`, `G` or `frf`, lines×outputs×inputs
/// or outputs×inputs×lines; the dimension with the number of frequencies decides, and where that is
/// the first and the last one the names, or `dimensions` (kLinesFirst, kLinesLast). Optional are
/// `variance`, `noise_variance`, `coherence` of the same size, `averages`, `output_names`,
/// `input_names`, `output_unit`, `input_unit`. An frd object as a structure is also accepted:
/// `ResponseData`, `Frequency`, `FrequencyUnit`, `OutputName`, `InputName`.
/// @param name  of the file, for messages
/// @throws InvalidInput  names the variable, what was found and what was expected
[[nodiscard]] FrfFile frf_of_mat(const MatFile& file, const std::string& name,
                                 const FrfOptions& options = {});

/// Variables that frf_of_mat reads back to the last bit, with units, nodes, directions and places.
[[nodiscard]] MatFields mat_of_frf(const modal::FrfSet& set);

}  // namespace chladni::io
