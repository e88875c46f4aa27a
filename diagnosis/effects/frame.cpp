#include <cmath>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> mass_frequency_damping(const Structure& structure) {
  const double typical_hz = first_hz(structure);
  return oscillator_parameters(10.0 * structure.mass_kg, typical_hz, 1.5);
}

// The frame moves along the normal: a channel stated against it sees it the other way round, one in
// the plane not at all.
void stand(State& state, const Structure& structure, Eigen::Index /*option*/, const VectorXd& x) {
  const auto [mass, damping, stiffness] = oscillator(x);
  Frame one;
  one.mass = mass;
  one.damping = damping;
  one.stiffness = stiffness;
  one.to_outputs = parts_along_normal(structure, structure.outputs);
  one.from_inputs = parts_along_normal(structure, structure.inputs);
  state.frames.push_back(std::move(one));
}

std::vector<EffectStart> frames(const Scene& scene) {
  std::vector<EffectStart> starts;
  const double low = std::max(0.3 * scene.low_hz(), 0.5);
  const double ratio = std::pow(1.3 * scene.high_hz() / low, 1.0 / 60.0);
  for (double times = 0.1; times < 300.0; times *= 5.0) {
    for (double f = low; f < 1.31 * scene.high_hz(); f *= ratio) {
      starts.push_back({0, Eigen::Vector3d(std::log(times * scene.structure().mass_kg), std::log(f),
                                           std::log(0.02))});
    }
  }
  return starts;
}

}  // namespace

constinit const Effect frame{
    .name = "frame",
    .summary = "the support moves: actuators push it back, sensors are measured against it",
    .source =
        "1 / (m s^2 + c s + k) added to all responses alike, with the part of each channel along "
        "the normal",
    .confusable = "a resonator on the body, a spring to ground",
    .parameters = mass_frequency_damping,
    .options = one_option,
    .channels = no_channels,
    .apply = stand,
    .starts = frames,
};

}  // namespace chladni::diagnosis
