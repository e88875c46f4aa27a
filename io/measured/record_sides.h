// The sides of a record, by recordings::Side: outputs, inputs, references.
#pragma once

#include <Eigen/Core>
#include <array>

#include "recordings/time_data.h"

namespace chladni::io {

inline constexpr std::array<const char*, 3> kSide{"output", "input", "reference"};
/// The samples of a side.
inline constexpr std::array<Eigen::MatrixXd recordings::Record::*, 3> kSamplesOf{
    &recordings::Record::outputs, &recordings::Record::inputs, &recordings::Record::references};

}  // namespace chladni::io
