#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/body_scale.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> mass_radius_place(const Structure& structure) {
  return {{.name = "mass",
           .unit = "kg",
           .scale = Parameter::Scale::logarithmic,
           .is_size = true,
           .centre = std::log(0.01 * structure.mass_kg),
           .width = 2.0,
           .step = 1e-4},
          {.name = "radius_of_gyration",
           .unit = "m",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::shape,
           .centre = std::log(0.03 * body_scale(structure)),
           .width = 1.0,
           .step = 1e-4},
          place_u(structure),
          place_v(structure)};
}

void hang_inertia(State& state, const Structure& structure, Eigen::Index /*option*/,
                  const VectorXd& x) {
  const auto motion = structure.surface.at({x(2), x(3)});
  const Eigen::Index r = structure.mode_count();
  Attached mass = mass_attached_to(structure, motion, std::exp(x(0)));
  Attached inertia;
  inertia.mass = mass.mass * std::exp(2.0 * x(1));
  inertia.shapes = Eigen::MatrixXd::Zero(r, 2);
  if (motion) {
    inertia.shapes << motion->slope_u, motion->slope_v;
    inertia.upper.resize(motion->upper_slope_u.size(), 2);
    inertia.upper << motion->upper_slope_u, motion->upper_slope_v;
  }
  state.attached.push_back(std::move(mass));
  state.attached.push_back(std::move(inertia));
}

std::vector<EffectStart> inertia_weights(const Scene& scene) {
  const double scale = body_scale(scene.structure());
  std::vector<VectorXd> sizes;
  for (double part = 1e-4; part < 0.3; part *= 2.2) {
    for (const double radius : {0.03, 0.1}) {
      sizes.push_back(
          Eigen::Vector2d(std::log(part * scene.structure().mass_kg), std::log(scale * radius)));
    }
  }
  return at_peaks(scene, sizes, 3);
}

// Rotary inertia depends on the slopes of the shapes, in which solvers differ more than in the
// shapes. A point mass from another solver was found with a radius of gyration of 12 mm, for 0.0006
// of its gain. Radii of 25 mm and more bring a tenth of the gain and more.
constexpr double kTurnsOtherwise = 0.002;

}  // namespace

constinit const Effect mass_with_inertia{
    .name = "mass_with_inertia",
    .summary = "a mass whose height or width resists rotation",
    .source = "s^2 m at a place and s^2 m r^2 at its two rotations, Woodbury",
    .confusable = "two masses; a resonator above the band",
    .parameters = mass_radius_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = hang_inertia,
    .starts = inertia_weights,
    .error = kHungError,
    .simpler = {{&point_mass, kTurnsOtherwise}},
    .in_study = {.table = InStudy::Table::attachment,
                 .kind = "mass",
                 .is_positive = true,
                 .keys = {{"mass", "mass", "kg"},
                          {.key = "inertia", .how = StudyKey::How::computed}}},
};

}  // namespace chladni::diagnosis
