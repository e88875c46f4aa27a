// Where the ticks of an axis are, and what is written at them.
#pragma once

#include <string>
#include <vector>

#include "io/plot.h"

namespace chladni::io {

struct PlotTick {
  double value = 0.0;
  std::string words;     ///< empty: a small tick without words
  std::string exponent;  ///< raised behind the words: "10" and "−3"
};

/// Of an axis with a range, `pixels` long. Linear: steps of 1, 2 or 5 times a power of ten.
/// Logarithmic: decades with small ticks between them, or 1, 2, 5 where there are few decades.
/// @param between  room that one label takes [px]
[[nodiscard]] std::vector<PlotTick> plot_ticks(const PlotAxis& axis, double pixels, double between);

/// The axis with a range that holds all values, widened by `room` (a part of the range) at both
/// ends where it was not given. Logarithmic: of the values above 0.
[[nodiscard]] PlotAxis ranged(PlotAxis axis, const std::vector<double>& values, double room);

/// Where a value lies, in [0, 1] inside the range; NaN where the axis has no place for it.
[[nodiscard]] double along(const PlotAxis& axis, double value);

}  // namespace chladni::io
