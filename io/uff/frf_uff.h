// Measured responses in universal files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/frf_file.h"
#include "io/uff/uff.h"

namespace chladni::io {

/// FRFs (dataset 58 of function type 4, or 0 where it is complex over frequency) with their
/// coherences (type 6); other functions are noted.
/// @throws InvalidInput  as parse_uff; unequal frequency lines or two different responses of one
///                       pair (names both)
[[nodiscard]] FrfFile parse_frf_uff(std::string_view bytes, const std::string& name,
                                    const FrfOptions& options = {});

/// In SI with 13 digits (text) or all of them (binary). `lost` gets what the format cannot hold.
/// @throws InvalidInput  a name of more than 60 letters or with a line end
[[nodiscard]] std::string frf_uff(const modal::FrfSet& set, UffEncoding encoding,
                                  std::vector<std::string>& lost);

}  // namespace chladni::io
