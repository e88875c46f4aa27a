// Functions in .mat files of Simcenter Testlab and of programs that write alike: one structure for
// each, with x_values, y_values and function_record.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/mat.h"
#include "io/time_file.h"

namespace chladni::io {

/// Whether a variable, or what it contains, is such a function.
[[nodiscard]] bool has_testlab_functions(const MatFields& variables);

/// The frequency responses among the functions, and their coherences, as the variables that
/// `frf_of_mat` reads. Notes what is not read.
/// @return  none: there are no responses
/// @throws InvalidInput  names the function, what was found and what was expected
[[nodiscard]] std::optional<MatFields> testlab_responses(const MatFields& variables,
                                                         const FrfOptions& options,
                                                         std::vector<std::string>& notes);

/// The recordings among the functions, one for each channel, as the variables that `time_of_mat`
/// reads. Notes and throws as `testlab_responses`.
[[nodiscard]] std::optional<MatFields> testlab_recordings(const MatFields& variables,
                                                          const TimeOptions& options,
                                                          std::vector<std::string>& notes);

}  // namespace chladni::io
