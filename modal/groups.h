// Groups of modes with equal or nearly equal frequencies.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::modal {

/// Neighbouring columns of the shapes: one mode, or several repeated or nearly repeated modes.
struct ModeGroup {
  Eigen::Index first = 0, size = 1;
};

/// Neighbours belong together while their frequencies differ by at most `tolerance` of the lower
/// one (chained; modal/repeated.h gives the tolerances). Tolerance 0 joins only equal frequencies.
/// @param frequency_hz  m, ascending
/// @returns             in order; their sizes sum to m
/// @throws InvalidInput  the frequencies are not ascending or not finite, tolerance is negative
[[nodiscard]] std::vector<ModeGroup> groups(const Eigen::VectorXd& frequency_hz, double tolerance);

}  // namespace chladni::modal
