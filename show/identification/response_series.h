// Responses as series of a plot.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/plot.h"
#include "modal/frf_set.h"

namespace chladni::show {

/// Radial part of the 95 % band of a circular error with variance 1: 1.96 / sqrt(2).
inline constexpr double kBandAlong = 1.3859;

/// Entry (i, j) of every line, K.
[[nodiscard]] inline Eigen::VectorXcd response(const std::vector<Eigen::MatrixXcd>& of,
                                               Eigen::Index i, Eigen::Index j) {
  Eigen::VectorXcd result(static_cast<Eigen::Index>(of.size()));
  for (std::size_t k = 0; k < of.size(); ++k) result(static_cast<Eigen::Index>(k)) = of[k](i, j);
  return result;
}

/// "s1 by a2": output i, input j.
[[nodiscard]] inline std::string response_name(const modal::FrfSet& set, Eigen::Index i,
                                               Eigen::Index j) {
  return set.outputs[static_cast<std::size_t>(i)].name + " by " +
         set.inputs[static_cast<std::size_t>(j)].name;
}

/// "receptance [m/N]": inputs without a unit are forces in N.
[[nodiscard]] inline std::string receptance_label(const modal::MeasuredChannel& input) {
  return "receptance [m/" + (input.unit.empty() ? "N" : input.unit) + "]";
}

/// "|response| [m/s^2/V]": without a unit where the output states none.
[[nodiscard]] inline std::string response_label(const modal::MeasuredChannel& output,
                                                const modal::MeasuredChannel& input) {
  if (output.unit.empty()) return "|response|";
  return "|response| [" + output.unit + "/" + (input.unit.empty() ? "N" : input.unit) + "]";
}

/// Lets the y axis of magnitudes go from half of the smallest to twice the largest value of its
/// curves. The lower edge of a band of what is all noise would lie decades below them.
inline void range_by_curves(io::PlotPanel& panel) {
  double least = HUGE_VAL, most = 0.0;
  for (const auto& series : panel.series) {
    if (series.style == io::PlotSeries::Style::band) continue;
    for (const double y : series.y) {
      if (!(y > 0.0) || !std::isfinite(y)) continue;
      least = std::min(least, y);
      most = std::max(most, y);
    }
  }
  if (!(most > 0.0)) return;
  panel.y.low = 0.5 * least;
  panel.y.high = 2.0 * most;
}

}  // namespace chladni::show
