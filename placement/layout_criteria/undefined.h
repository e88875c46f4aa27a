// The score of a layout to which a criterion does not apply.
#pragma once

#include <limits>

namespace chladni::placement {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

}  // namespace chladni::placement
