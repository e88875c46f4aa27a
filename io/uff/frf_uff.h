// Measured responses in universal files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/frf_file.h"
#include "io/uff/uff.h"

namespace chladni::io {

/// Reads FRFs (dataset 58 of function type 4, or of type 0 if it is complex over frequency) with
/// their coherences (type 6). Other functions are noted.
/// @throws InvalidInput  as parse_uff; or the frequency lines differ, or one pair has two different
///                       responses (names both)
[[nodiscard]] FrfFile parse_frf_uff(std::string_view bytes, const std::string& name,
                                    const FrfOptions& options = {});

/// A universal file in SI with 13 digits (text) or all digits (binary). `lost` gets the information
/// that the format cannot hold.
/// @throws InvalidInput  a name has more than 60 letters or a line end
[[nodiscard]] std::string frf_uff(const modal::FrfSet& set, UffEncoding encoding,
                                  std::vector<std::string>& lost);

}  // namespace chladni::io
