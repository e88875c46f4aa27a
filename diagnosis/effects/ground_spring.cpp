#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

double typical_stiffness(const Structure& structure) {
  const double omega = first_omega(structure);
  return 0.01 * structure.mass_kg * omega * omega;
}

std::vector<Parameter> stiffness_and_place(const Structure& structure) {
  return {{.name = "stiffness",
           .unit = "N/m",
           .scale = Parameter::Scale::logarithmic,
           .is_size = true,
           .centre = std::log(typical_stiffness(structure)),
           .width = 3.0,
           .step = 1e-4},
          place_u(structure),
          place_v(structure)};
}

void hold_point(State& state, const Structure& structure, Eigen::Index /*option*/,
                const VectorXd& x) {
  Attached one = attached_at(structure, x(1), x(2));
  one.stiffness = std::exp(x(0));
  state.attached.push_back(std::move(one));
}

std::vector<EffectStart> springs(const Scene& scene) {
  std::vector<VectorXd> sizes;
  for (double times = 1e-5; times < 1e3; times *= 2.0) {
    sizes.push_back(VectorXd::Constant(1, std::log(times * typical_stiffness(scene.structure()))));
  }
  return at_peaks(scene, sizes);
}

}  // namespace

constinit const Effect ground_spring{
    .name = "ground_spring",
    .summary = "something holds the body: flexure, cable, gravity compensator",
    .source = "k at a place, Woodbury",
    .confusable = "a frame, what a closed loop leaves at low frequency",
    .parameters = stiffness_and_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = hold_point,
    .starts = springs,
    .error = kHungError,
    .in_study = {.table = InStudy::Table::attachment,
                 .kind = "spring",
                 .along_normal = true,
                 .keys = {{"stiffness", "stiffness", "N/m"}}},
};

}  // namespace chladni::diagnosis
