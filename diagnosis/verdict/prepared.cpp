#include "diagnosis/verdict/prepared.h"

#include <numbers>
#include <utility>

namespace chladni::diagnosis {
namespace {

// What a cause does goes with the square of the shapes where it is, on all modes at once. Where
// channels saw shapes off by 0.1 %, masses, springs and tapers in models of other elements were
// found off by 1 to 3 %.
constexpr double kOfACause = 10.0;

// Modes up to these parts of the band have frequencies and dampings of their own, and shapes. Some
// hundredths of what modes above it add within it are loss, which a fifth of their damping makes
// uncertain by more than the noise of thousands of lines: masses of -14 g were made of it.
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
