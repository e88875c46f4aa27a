// What the effects that hang on a place of the surface share.
#pragma once

#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

/// Effect::error of what hangs on modes of finite number: against an independent plate it left
/// 0.001 to 0.004 of what it explains.
inline constexpr double kHungError = 0.005;

/// "u" and "v" of the place.
[[nodiscard]] Parameter place_u();
[[nodiscard]] Parameter place_v();
/// 0 without a surface to hang on.
[[nodiscard]] Eigen::Index has_surface(const Structure& structure);
/// At (u, v), of one displacement along the normal; of zero shape beside the surface.
[[nodiscard]] Attached attached_at(const Structure& structure, double u, double v);
/// The same where the motion of the place is known; none: beside the surface.
[[nodiscard]] Attached attached_to(const Structure& structure,
                                   const std::optional<PointMotion>& motion);
/// A mass on a spring and a dashpot, of the coordinates ln mass, ln frequency, ln damping ratio.
struct Oscillator {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
};
[[nodiscard]] Oscillator oscillator(const Eigen::VectorXd& x);
/// ω₁ [rad/s], of the first flexible mode.
[[nodiscard]] double first_omega(const Structure& structure);
/// Each of `sizes` (one set of leading coordinates) at the likeliest places of the scan.
[[nodiscard]] std::vector<EffectStart> at_peaks(const Scene& scene,
                                                const std::vector<Eigen::VectorXd>& sizes,
                                                std::size_t peaks = 6);

}  // namespace chladni::diagnosis
