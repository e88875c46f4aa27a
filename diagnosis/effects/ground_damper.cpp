#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

double typical_damping(const Structure& structure) {
  return 0.01 * structure.mass_kg * first_omega(structure);
}

std::vector<Parameter> damping_and_place(const Structure& structure) {
  return {{.name = "damping",
           .unit = "N s/m",
           .scale = Parameter::Scale::logarithmic,
           .is_size = true,
           .centre = std::log(typical_damping(structure)),
           .width = 2.5,
           .step = 1e-4},
          place_u(structure),
          place_v(structure)};
}

void drag(State& state, const Structure& structure, Eigen::Index /*option*/, const VectorXd& x) {
  Attached one = attached_at(structure, x(1), x(2));
  one.damping = std::exp(x(0));
  state.attached.push_back(std::move(one));
}

std::vector<EffectStart> dashpots(const Scene& scene) {
  std::vector<VectorXd> sizes;
  for (double times = 1e-4; times < 300.0; times *= 2.0) {
    sizes.push_back(VectorXd::Constant(1, std::log(times * typical_damping(scene.structure()))));
  }
  return at_peaks(scene, sizes);
}

}  // namespace

constinit const Effect ground_damper{
    .name = "ground_damper",
    .summary = "a damper in one place: eddy currents, a cable that rubs, a pad",
    .source = "s c at a place, Woodbury; modes become complex",
    .confusable = "modal damping where a pair is degenerate",
    .parameters = damping_and_place,
    .options = has_surface,
    .channels = no_channels,
    .apply = drag,
    .starts = dashpots,
    .error = kHungError,
    .in_study = {.table = InStudy::Table::attachment,
                 .kind = "damper",
                 .along_normal = true,
                 .keys = {{"damping", "damping", "N s/m"}}},
};

}  // namespace chladni::diagnosis
