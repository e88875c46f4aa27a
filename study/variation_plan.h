// Deviations of a body from its stated material and geometry.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "study/place.h"

namespace chladni::study {

/// Stiffness or thickness over the body, relative to the nominal value. A patch has 1 + `relative`,
/// with a smooth rim (e^{−(π/4)(d/R)⁴} has the area of a disc of radius R). Waves have 1 + Σ waves,
/// Legendre polynomials over the body's box seen from above.
struct VariationPlan {
  std::string of;  ///< "stiffness", or "thickness": t³ in stiffness, t in mass
  std::optional<Place> at;
  double radius = 0.0;    ///< [m]
  double relative = 0.0;  ///< at the centre of the patch
  std::array<double, 5> waves{};
};

/// Names of the waves: P₁(u), P₁(v), P₂(u), P₁(u)P₁(v), P₂(v).
inline constexpr std::array<std::string_view, 5> kVariationWaves{"u1", "v1", "u2", "u1v1", "v2"};

}  // namespace chladni::study
