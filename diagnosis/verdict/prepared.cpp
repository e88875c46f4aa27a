#include "diagnosis/verdict/prepared.h"

#include <numbers>
#include <utility>

namespace chladni::diagnosis {
namespace {

// The effect of a cause on all modes is proportional to the square of the shapes at its place. When
// the shapes at the channels were wrong by 0.1 %, masses, springs and tapers in models of other
// elements were found with errors of 1 to 3 %. So this is the ratio of the two errors.
constexpr double kOfACause = 10.0;

// Modes up to these multiples of the band have their own frequencies and dampings, and shapes. Some
// hundredths of the contribution of modes above the band to it are loss. Their damping is known to
// 20 % only, so this loss is more uncertain than the noise of thousands of lines. Without dampings
// of their own the fit invented masses of -14 g.
constexpr double kOwnFrequencies = 3.0;
constexpr double kOwnShapes = 1.6;

}  // namespace

Observed Prepared::for_search(int lines) const {
  return thinned(widened(observed, model_variance(observed, response)), lines);
}

std::vector<Deviation> Prepared::all_deviations() const {
  auto all = tolerable;
  all.insert(all.end(), shapes.begin(), shapes.end());
  return all;
}

Prepared prepared(const Structure& structure, const modal::FrfSet& measured,
                  const Tolerances& tolerances) {
  const double high_hz = 0.9 * structure.frequency_hz(structure.mode_count() - 1);
  auto [own, observed, notes] = seen(structure, measured, high_hz);
  const double band_hz = observed.omega(observed.line_count() - 1) / (2.0 * std::numbers::pi);
  auto kept = std::make_shared<const Structure>(std::move(own));
  auto tolerable = deviations(*kept, tolerances, kOwnFrequencies * band_hz);
  auto shapes = shape_deviations(*kept, tolerances.response, kOwnShapes * band_hz);
  return {std::move(kept),
          std::move(observed),
          std::move(notes),
          std::move(tolerable),
          std::move(shapes),
          tolerances.response,
          kOfACause * tolerances.response};
}

}  // namespace chladni::diagnosis
