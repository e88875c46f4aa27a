#include <utility>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The standard deviation of their total mass is 30 % of the body.
template <Side side>
std::vector<Parameter> of_each(const Structure& structure) {
  const double share =
      structure.mass_kg / static_cast<double>(channels_of<side>(structure).count());
  return {{.name = "mass",
           .unit = "kg",
           .is_size = true,
           .width = 0.3 * share,
           .step = 1e-6 * structure.mass_kg}};
}

template <Side side>
Index are_on_the_surface(const Structure& structure) {
  if (has_surface(structure) == 0) return 0;
  const auto& places = channels_of<side>(structure).places;
  for (const auto place : places.rowwise()) {
    if (!structure.surface.holds(place.transpose())) return 0;
  }
  return places.rows() > 1 ? has_surface(structure) : 0;
}

template <Side side>
std::function<void(State&)> carrying(const Structure& structure, Index /*option*/,
                                     const VectorXd& x) {
  std::vector<Attached> all;
  for (const auto place : channels_of<side>(structure).places.rowwise()) {
    const auto motion = structure.surface.at(place.transpose());
    all.push_back(mass_attached_to(structure, motion, x(0)));
  }
  return [all = std::move(all)](State& state) {
    state.attached.insert(state.attached.end(), all.begin(), all.end());
  };
}

// In total from a hundred-thousandth of the body to all of it, and the same negative.
template <Side side>
std::vector<EffectStart> channel_weights(const Scene& scene) {
  const auto& structure = scene.structure();
  const auto count = static_cast<double>(channels_of<side>(structure).count());
  std::vector<EffectStart> starts;
  for (double part = 1e-5; part < 1.0; part *= 1.6) {
    for (const double sign : {-1.0, 1.0}) {
      starts.push_back({0, VectorXd::Constant(1, sign * part * structure.mass_kg / count)});
    }
  }
  return starts;
}

constexpr std::string_view kMassesSource = "s^2 m at the place of each, Woodbury";

}  // namespace

constinit const Effect sensor_masses{
    .name = "sensor_masses",
    .summary = "every sensor weighs something that the model lacks: accelerometers",
    .source = kMassesSource,
    .confusable = "density, masses of the actuators where they are collocated",
    .parameters = of_each<Side::sensors>,
    .options = are_on_the_surface<Side::sensors>,
    .channels = no_channels,
    .apply = at_once<carrying<Side::sensors>>,
    .starts = channel_weights<Side::sensors>,
    .change = carrying<Side::sensors>,
    .error = kHungError,
    .tolerance = &Tolerances::mass,
    .in_study = {.table = InStudy::Table::sensor_attachments,
                 .kind = "mass",
                 .is_positive = true,
                 .keys = {{"mass", "mass", "kg"}}},
};
constinit const Effect actuator_masses{
    .name = "actuator_masses",
    .summary = "every actuator carries a mass that the model lacks: coils, magnets",
    .source = kMassesSource,
    .confusable = "density, masses of the sensors where they are collocated",
    .parameters = of_each<Side::actuators>,
    .options = are_on_the_surface<Side::actuators>,
    .channels = no_channels,
    .apply = at_once<carrying<Side::actuators>>,
    .starts = channel_weights<Side::actuators>,
    .change = carrying<Side::actuators>,
    .error = kHungError,
    .tolerance = &Tolerances::mass,
    .in_study = {.table = InStudy::Table::actuator_attachments,
                 .kind = "mass",
                 .is_positive = true,
                 .keys = {{"mass", "mass", "kg"}}},
};

}  // namespace chladni::diagnosis
