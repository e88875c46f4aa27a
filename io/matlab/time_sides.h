// The sides of a recording in a .mat file: outputs, inputs and references.
#pragma once

#include <Eigen/Core>
#include <array>

#include "io/matlab/mat_names.h"
#include "recordings/time_data.h"

namespace chladni::io {

inline constexpr std::array<const char*, 3> kVariable{"y", "u", "r"};
inline constexpr std::array<const char*, 3> kSide{"output", "input", "reference"};
inline constexpr std::array<Eigen::MatrixXd recordings::Record::*, 3> kParts{
    &recordings::Record::outputs, &recordings::Record::inputs, &recordings::Record::references};

/// The variable with the samples of a side; null where there is none.
[[nodiscard]] inline const MatValue* variable_of(const MatFields& fields, std::size_t side) {
  return side == 0   ? mat_value(fields, {"y", "outputs", "output"})
         : side == 1 ? mat_value(fields, {"u", "inputs", "input", "force"})
                     : mat_value(fields, {"r", "references", "reference"});
}

}  // namespace chladni::io
