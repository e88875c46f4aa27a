#include "diagnosis/verdict/nonlinearity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Sums over some lines and all channels.
struct Power {
  double responses = 0.0, variance = 0.0, noise = 0.0;  // relative
};

Power power_of(const modal::FrfSet& set, Index first, Index count) {
  Power sum;
  for (Index k = first; k < first + count; ++k) {
    const auto n = static_cast<std::size_t>(k);
    for (Index c = 0; c < set.value[n].size(); ++c) {
      const double response = std::norm(set.value[n](c));
      const double variance = set.variance[n](c);
      const double noise = set.noise_variance[n](c);
      if (!(response > 0.0) || !std::isfinite(response + variance + noise)) continue;
      sum.responses += 1.0;
      sum.variance += variance / response;
      sum.noise += std::min(noise, variance) / response;
    }
  }
  return sum;
}

double level_of(const Power& sum) {
  return sum.responses > 0.0 ? std::sqrt((sum.variance - sum.noise) / sum.responses) : 0.0;
}

}  // namespace

Nonlinearity nonlinearity(const modal::FrfSet& measured) {
  Nonlinearity found;
  if (measured.variance.empty() || measured.noise_variance.empty()) return found;
  const Index lines = measured.line_count();
  const auto whole = power_of(measured, 0, lines);
  if (whole.variance <= 0.0) return found;
  found.share = 1.0 - whole.noise / whole.variance;
  found.level = level_of(whole);
  const Index bands = std::min<Index>(kConstants.bands, lines);
  for (Index b = 0; b < bands; ++b) {
    const Index first = lines * b / bands;
    const Index count = lines * (b + 1) / bands - first;
    const double level = level_of(power_of(measured, first, count));
    if (level <= found.strongest) continue;
    found.strongest = level;
    found.strongest_hz =
        0.5 * (measured.frequency_hz(first) + measured.frequency_hz(first + count - 1));
  }
  return found;
}

std::string nonlinearity_note(const modal::FrfSet& measured) {
  const auto found = nonlinearity(measured);
  if (found.share < kConstants.nonlinear_share) return {};
  return fmt::format(
      "{:.0f} % of the variance changes with the realisation, not with the period: the structure "
      "is not linear at this level ({:.2g} % of the responses, most near {:.4g} Hz, {:.2g} %); "
      "measure at two levels",
      100.0 * found.share, 100.0 * found.level, found.strongest_hz, 100.0 * found.strongest);
}

}  // namespace chladni::diagnosis
