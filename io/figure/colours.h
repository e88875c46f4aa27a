// The colours of quantities in pictures.
#pragma once

#include <array>
#include <cstddef>

namespace chladni::io {

using Colour = std::array<double, 3>;  // sRGB in [0, 1]

/// Diverging: blue −1, white 0, red +1, in even steps of CIELAB between the colours of
/// ColorBrewer's RdBu (C. Brewer 2003). @param value  is cut off at ±1
[[nodiscard]] Colour diverging(double value);

/// From dark to light: 0 violet, 1 yellow, in even steps of CIELAB between five colours of
/// matplotlib's viridis (van der Walt and Smith 2015). @param value  is cut off at 0 and 1
[[nodiscard]] Colour sequential(double value);

/// Light colours that are easily told apart, for dark letters on them: ColorBrewer's Set3
/// (C. Brewer 2003). @param number  from 0; counts anew after kCategories
inline constexpr std::size_t kCategories = 12;
[[nodiscard]] Colour categorical(int number);

}  // namespace chladni::io
