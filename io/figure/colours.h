// The colours of quantities in pictures.
#pragma once

#include <array>
#include <cstddef>

namespace chladni::io {

using Colour = std::array<double, 3>;  // sRGB in [0, 1]

/// A diverging colour: blue −1, white 0, red +1, in even steps of CIELAB between the colours of
/// ColorBrewer's RdBu (C. Brewer 2003). @param value  is limited to ±1
[[nodiscard]] Colour diverging(double value);

/// A colour from dark to light: 0 violet, 1 yellow, in even steps of CIELAB between five colours of
/// matplotlib's viridis (van der Walt and Smith 2015). @param value  is limited to 0 and 1
[[nodiscard]] Colour sequential(double value);

/// A light colour that is easily distinguished from the others, with dark letters on it:
/// ColorBrewer's Set3 (C. Brewer 2003). @param number  from 0; repeats after kCategories
inline constexpr std::size_t kCategories = 12;
[[nodiscard]] Colour categorical(int number);

}  // namespace chladni::io
