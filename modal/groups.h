// Modes that cannot be told apart, taken together.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::modal {

/// Neighbouring columns of the shapes: one mode, or several that are repeated or nearly so.
struct ModeGroup {
  Eigen::Index first = 0, size = 1;
};

/// Neighbours belong together while their frequencies differ by at most `tolerance` of the lower
/// one (chained; modal/repeated.h says which tolerance is for what). Tolerance 0 takes only equal
/// ones together.
/// @param frequency_hz  m, ascending
/// @returns             in order; their sizes sum to m
/// @throws InvalidInput  the frequencies are not ascending or not finite, tolerance is negative
[[nodiscard]] std::vector<ModeGroup> groups(const Eigen::VectorXd& frequency_hz, double tolerance);

}  // namespace chladni::modal
