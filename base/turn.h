// The angle of a whole turn.
#pragma once

#include <numbers>

namespace chladni {

/// [rad]: angular frequency over frequency.
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

}  // namespace chladni
