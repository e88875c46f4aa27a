// What a diagnosis of modes is given, on the channels that structure and measurement share.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/measured_modes.h"
#include "diagnosis/structure.h"

namespace chladni::diagnosis {

struct Given {
  Structure structure;
  MeasuredModes measured;
  std::vector<std::string> notes;  ///< channels that were left out
};

/// Structure and measurement with the channels that both have, in the order of the structure.
/// @throws InvalidInput  as check of both; sensors were measured, and the structure has none of
/// them
[[nodiscard]] Given given(const Structure& structure, const MeasuredModes& measured);

}  // namespace chladni::diagnosis
