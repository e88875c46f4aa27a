#include "diagnosis/effects/attachment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/effects/body_scale.h"

namespace chladni::diagnosis {

Parameter place_u(const Structure& structure) {
  return {
      .name = "u", .unit = "m", .role = Parameter::Role::place_u, .step = place_step(structure)};
}
Parameter place_v(const Structure& structure) {
  return {
      .name = "v", .unit = "m", .role = Parameter::Role::place_v, .step = place_step(structure)};
}

Eigen::Index has_surface(const Structure& structure) {
  return structure.surface.count() > 0 ? 1 : 0;
}

Attached attached_at(const Structure& structure, double u, double v) {
  return attached_to(structure, structure.surface.at({u, v}));
}

Attached attached_to(const Structure& structure, const std::optional<PointMotion>& motion) {
  Attached one;
  one.shapes = motion ? motion->shape : Eigen::VectorXd::Zero(structure.mode_count());
  if (motion) one.upper = motion->upper;
  return one;
}

Attached mass_attached_to(const Structure& structure, const std::optional<PointMotion>& motion,
                          double mass) {
  Attached one = attached_to(structure, motion);
  one.mass = mass;
  const Eigen::Index aside = structure.surface.directions - 1;
  if (aside == 0) return one;
  // Outside the surface, too: one place has as many displacements as another.
  one.shapes.conservativeResizeLike(Eigen::MatrixXd::Zero(one.shapes.rows(), 1 + aside));
  if (!motion) return one;
  one.shapes.rightCols(aside) = motion->aside;
  if (one.upper.size() == 0) return one;
  one.upper.conservativeResize(Eigen::NoChange, 1 + aside);
  one.upper.rightCols(aside) = motion->upper_aside;
  return one;
}

std::vector<Parameter> oscillator_parameters(double mass_kg, double frequency_hz, double width) {
  return {{.name = "mass",
           .unit = "kg",
           .scale = Parameter::Scale::logarithmic,
           .is_size = true,
           .centre = std::log(mass_kg),
           .width = 2.0,
           .step = 1e-4},
          {.name = "frequency",
           .unit = "Hz",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::frequency,
           .centre = std::log(frequency_hz),
           .width = width,
           .step = 1e-5},
          {.name = "damping_ratio",
           .unit = "1",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::shape,
           .centre = std::log(0.02),
           .width = 1.0,
           .step = 1e-4}};
}

Oscillator oscillator(const Eigen::VectorXd& x) {
  const double omega = 2.0 * std::numbers::pi * std::exp(x(1));
  const double mass = std::exp(x(0));
  return {mass, 2.0 * std::exp(x(2)) * omega * mass, mass * omega * omega};
}

double first_omega(const Structure& structure) {
  constexpr double kMostInSprings = 0.5;  // of a mode's energy
  const auto& springs = structure.springs;
  for (Eigen::Index i = structure.rigid_count; i < structure.mode_count(); ++i) {
    const double omega = 2.0 * std::numbers::pi * structure.frequency_hz(i);
    if (springs.size() == 0 || springs(i, i) < kMostInSprings * omega * omega) return omega;
  }
  return 2.0 * std::numbers::pi * structure.frequency_hz(structure.mode_count() - 1);
}

double first_hz(const Structure& structure) {
  return first_omega(structure) / (2.0 * std::numbers::pi);
}

std::vector<EffectStart> at_peaks(const Scene& scene, const std::vector<Eigen::VectorXd>& sizes,
                                  std::size_t peaks) {
  std::vector<EffectStart> starts;
  const auto& places = scene.structure().surface.places;
  const auto& found = scene.places().peaks;
  for (std::size_t n = 0; n < std::min(peaks, found.size()); ++n) {
    for (const auto& size : sizes) {
      Eigen::VectorXd x(size.size() + 2);
      x << size, places(found[n], 0), places(found[n], 1);
      starts.push_back({0, x});
    }
  }
  return starts;
}

}  // namespace chladni::diagnosis
