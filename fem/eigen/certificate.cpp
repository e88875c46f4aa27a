#include "fem/eigen/certificate.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace chladni::fem {

Count counted_in_gap(const Symbolic& symbolic, const System& system, double low, double high) {
  // Fractions of the gap. The middle comes first because it is farthest from both ends.
  constexpr std::array places{0.5, 0.38, 0.62, 0.27, 0.73};
  Count count;
  Inertia found;
  for (const double place : places) {
    ++count.attempts;
    count.at = low + place * (high - low);
    found = inertia(symbolic, system.stiffness, -count.at, system.mass);
    count.below = found.negative;
    if (found.trusted()) return count;
  }
  const auto hz = [](double lambda) { return std::sqrt(lambda) / (2.0 * std::numbers::pi); };
  throw NumericalFailure(fmt::format(
      "modes: the eigenvalues below the gap from {:.6g} to {:.6g} Hz cannot be counted: the "
      "smallest pivot is {:.2g} of its row (expected more than {:.0e}) and the elimination made "
      "entries grow by {:.2g} (expected less than {:.0e}); ask for another count of modes, or no "
      "certificate",
      hz(low), hz(high), found.smallest_pivot, Inertia::kLeastPivot, found.growth,
      Inertia::kMostGrowth));
}

}  // namespace chladni::fem
