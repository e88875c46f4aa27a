// Where a body is not as its material and geometry say.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "app/study/place.h"

namespace chladni::app {

/// Stiffness or thickness over the body, relative to what it would be: 1 + `relative` within a
/// patch (falling smoothly: e^{−(π/4)(d/R)⁴} has the area of a disc of radius R), and 1 + Σ waves,
/// Legendre's polynomials over the body's box seen from above.
struct VariationPlan {
  std::string of;  ///< "stiffness", or "thickness": its cube in stiffness, itself in mass
  std::optional<Place> at;
  double radius = 0.0;    ///< [m]
  double relative = 0.0;  ///< in the middle of the patch
  std::array<double, 5> waves{};
};

/// Names of the waves: P₁(u), P₁(v), P₂(u), P₁(u)P₁(v), P₂(v).
inline constexpr std::array<std::string_view, 5> kVariationWaves{"u1", "v1", "u2", "u1v1", "v2"};

}  // namespace chladni::app
