// Shared parts of the effects that hang on a place of the surface.
#pragma once

#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

/// Effect::error of an attachment, because the number of modes is finite. Against an independent
/// plate it left 0.001 to 0.004 of what it explains.
inline constexpr double kHungError = 0.005;

/// Coordinates "u" and "v" of the place.
[[nodiscard]] Parameter place_u(const Structure& structure);
[[nodiscard]] Parameter place_v(const Structure& structure);
/// 0 if there is no surface to attach to.
[[nodiscard]] Eigen::Index has_surface(const Structure& structure);
/// An attachment at (u, v) with one displacement along the normal; zero shape outside the surface.
[[nodiscard]] Attached attached_at(const Structure& structure, double u, double v);
/// The same for a known motion of the place; none: outside the surface.
[[nodiscard]] Attached attached_to(const Structure& structure,
                                   const std::optional<PointMotion>& motion);
/// A mass [kg] at a place, which moves with it along the normal, the first of its displacements,
/// and aside, where the motion of the surface has these parts.
[[nodiscard]] Attached mass_attached_to(const Structure& structure,
                                        const std::optional<PointMotion>& motion, double mass);
/// A mass on a spring and a dashpot, from the coordinates ln mass, ln frequency, ln damping ratio.
struct Oscillator {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
};
[[nodiscard]] Oscillator oscillator(const Eigen::VectorXd& x);
/// Its parameters "mass", "frequency" and "damping_ratio", with the centres of the first two
/// priors; `width` is that of ln frequency.
[[nodiscard]] std::vector<Parameter> oscillator_parameters(double mass_kg, double frequency_hz,
                                                           double width);
/// ω₁ [rad/s] of the first mode in which the body bends: known springs hold less than half of its
/// energy, so that a body on its suspension has about the scale that it has when it is free.
[[nodiscard]] double first_omega(const Structure& structure);
/// The same as a frequency [Hz].
[[nodiscard]] double first_hz(const Structure& structure);
/// Starts: each of `sizes` (one set of leading coordinates) at the likeliest places of the scan.
[[nodiscard]] std::vector<EffectStart> at_peaks(const Scene& scene,
                                                const std::vector<Eigen::VectorXd>& sizes,
                                                std::size_t peaks = 6);

}  // namespace chladni::diagnosis
