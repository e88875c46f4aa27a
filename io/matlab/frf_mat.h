// Measured responses in .mat files.
#pragma once

#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/mat.h"

namespace chladni::io {

/// What the variables say: frequencies (`freq_hz`, `frequency_hz`, `frequency`, `freq`, `f`; `w`
/// and `omega` in rad/s), responses (`H`, `G`, `frf`) lines×outputs×inputs or outputs×inputs×lines,
/// by where the number of frequencies stands; optionally `variance`, `noise_variance`,
/// `coherence` of the same size, `averages`, `output_names`, `input_names`, `output_unit`,
/// `input_unit`. Or an frd object as a structure: `ResponseData`, `Frequency`, `FrequencyUnit`,
/// `OutputName`, `InputName`.
/// @param name  of the file, for messages
/// @throws InvalidInput  names the variable, what was found and what was expected
[[nodiscard]] FrfFile frf_of_mat(const MatFile& file, const std::string& name,
                                 const FrfOptions& options = {});

/// What frf_of_mat reads back to the last bit, units, nodes, directions and places too.
[[nodiscard]] MatFields mat_of_frf(const modal::FrfSet& set);

}  // namespace chladni::io
