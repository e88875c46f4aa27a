// The sides of a recording in a .mat file: outputs, inputs and references.
#pragma once

#include <array>

#include "io/matlab/mat_names.h"
#include "io/measured/record_sides.h"

namespace chladni::io {

inline constexpr std::array<const char*, 3> kVariable{"y", "u", "r"};

/// The variable with the samples of a side; null where there is none.
[[nodiscard]] inline const MatValue* variable_of(const MatFields& fields, std::size_t side) {
  return side == 0   ? mat_value(fields, {"y", "outputs", "output"})
         : side == 1 ? mat_value(fields, {"u", "inputs", "input", "force"})
                     : mat_value(fields, {"r", "references", "reference"});
}

}  // namespace chladni::io
