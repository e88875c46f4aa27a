// The colours of quantities in pictures.
#pragma once

#include <array>

namespace chladni::io {

using Colour = std::array<double, 3>;  // sRGB in [0, 1]

/// Diverging: blue −1, white 0, red +1, in even steps of CIELAB between the colours of
/// ColorBrewer's RdBu (C. Brewer 2003). @param value  is cut off at ±1
[[nodiscard]] Colour diverging(double value);

/// From dark to light: 0 violet, 1 yellow, in even steps of CIELAB between five colours of
/// matplotlib's viridis (van der Walt and Smith 2015). @param value  is cut off at 0 and 1
[[nodiscard]] Colour sequential(double value);

}  // namespace chladni::io
