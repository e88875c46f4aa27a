#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> mass_and_place(const Structure& structure) {
  return {{.name = "mass",
           .unit = "kg",
           .is_size = true,
           .width = 0.03 * structure.mass_kg,
           .step = 1e-6 * structure.mass_kg},
          place_u(structure),
          place_v(structure)};
}

void hang_mass(State& state, const Structure& structure, Eigen::Index /*option*/,
               const VectorXd& x) {
  state.attached.push_back(mass_attached_to(structure, structure.surface.at({x(1), x(2)}), x(0)));
}

// From a hundred-thousandth to a third of the body, and the same negative.
std::vector<EffectStart> mass_weights(const Scene& scene) {
  std::vector<VectorXd> sizes;
  for (double part = 1e-5; part < 0.3; part *= 1.6) {
    sizes.push_back(VectorXd::Constant(1, part * scene.structure().mass_kg));
    sizes.push_back(VectorXd::Constant(1, -part * scene.structure().mass_kg));
  }
  return at_peaks(scene, sizes);
}

}  // namespace

constinit const Effect point_mass{
    .name = "point_mass",
    .summary = "a mass on the body that the model lacks (negative: missing material)",
    .source = "s^2 m at a place in all its directions, Woodbury",
    .confusable = "a resonator far above the band; stiffness lost under it",
    .parameters = mass_and_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = hang_mass,
    .starts = mass_weights,
    .error = kHungError,
    .in_study = {.table = InStudy::Table::attachment,
                 .kind = "mass",
                 .is_positive = true,
                 .keys = {{"mass", "mass", "kg"}}},
};

}  // namespace chladni::diagnosis
