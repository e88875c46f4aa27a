// The ticks of an axis and their labels.
#pragma once

#include <string>
#include <vector>

#include "io/plot.h"

namespace chladni::io {

struct PlotTick {
  double value = 0.0;
  std::string words;     ///< empty: a small tick without words
  std::string exponent;  ///< superscript after the words: "10" and "−3"
};

/// The ticks of an axis with a range, `pixels` long. A linear axis has steps of 1, 2 or 5 times a
/// power of ten. A logarithmic axis has decades with small ticks between them, or 1, 2, 5 where
/// there are few decades. @param between  room for one label [px]
[[nodiscard]] std::vector<PlotTick> plot_ticks(const PlotAxis& axis, double pixels, double between);

/// The axis with a range. Where no range is given, the range holds all values (on a logarithmic
/// axis all values above 0) and is widened by `room` (a fraction of the range) at both ends.
[[nodiscard]] PlotAxis ranged(PlotAxis axis, const std::vector<double>& values, double room);

/// The position of a value, in [0, 1] inside the range; NaN where the axis cannot show the value.
[[nodiscard]] double along(const PlotAxis& axis, double value);

}  // namespace chladni::io
