// The colours of a quantity that is positive here and negative there.
#pragma once

#include <array>

namespace chladni::io {

using Colour = std::array<double, 3>;  // sRGB in [0, 1]

/// Diverging: blue −1, white 0, red +1, in even steps of CIELAB between the colours of
/// ColorBrewer's RdBu (C. Brewer 2003). @param value  is cut off at ±1
[[nodiscard]] Colour diverging(double value);

}  // namespace chladni::io
