#include <cmath>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

std::vector<Parameter> gain_parameters(const Structure& /*structure*/) {
  return {{.name = "relative",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .width = 0.2,
           .step = 1e-4}};
}

template <Side side>
void apply_gain(State& state, const Structure& /*structure*/, Index option,
                const Eigen::VectorXd& x) {
  paths_of<side>(state)[static_cast<std::size_t>(option)].gain *= std::exp(x(0));
}

template <Side side>
std::vector<EffectStart> gain_starts(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (Index i = 0; i < each_channel<side>(scene.structure()); ++i) {
    const double factor = channel_factor<side>(scene, i);
    if (factor > 0.05) starts.push_back({i, Eigen::VectorXd::Constant(1, std::log(factor))});
  }
  return starts;
}

void apply_overall(State& state, const Structure& /*structure*/, Index /*option*/,
                   const Eigen::VectorXd& x) {
  for (auto& path : state.output_paths) path.gain *= std::exp(x(0));
}

std::vector<EffectStart> overall_starts(const Scene& scene) {
  const auto gain = scene.gain(scene.now().value);
  if (gain.step <= -0.95) return {};
  return {{0, Eigen::VectorXd::Constant(1, std::log1p(gain.step))}};
}

constexpr StudyKey kGainKey{"gain", "relative", "", StudyKey::How::times_one_plus};
constexpr std::string_view kGainSource = "a real factor on a row or column of the responses";

}  // namespace

constinit const Effect sensor_gain{
    .name = "sensor_gain",
    .summary = "a sensor reads too much or too little",
    .source = kGainSource,
    .confusable = "its place or direction (changes over frequency), density",
    .parameters = gain_parameters,
    .options = each_channel<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = apply_gain<Side::sensors>,
    .starts = gain_starts<Side::sensors>,
    .simpler = {{&sensor_sign}},
    .tolerance = &Tolerances::gain,
    .is_gain = true,
    .in_study = {.table = InStudy::Table::sensors, .keys = {kGainKey}},
};
constinit const Effect actuator_gain{
    .name = "actuator_gain",
    .summary = "an actuator gives more or less force than it says",
    .source = kGainSource,
    .confusable = "its place or direction (changes over frequency)",
    .parameters = gain_parameters,
    .options = each_channel<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = apply_gain<Side::actuators>,
    .starts = gain_starts<Side::actuators>,
    .simpler = {{&actuator_sign}},
    .tolerance = &Tolerances::gain,
    .is_gain = true,
    .in_study = {.table = InStudy::Table::actuators, .keys = {kGainKey}},
};
constinit const Effect overall_gain{
    .name = "overall_gain",
    .summary = "all responses share a wrong scale",
    .source = kGainSource,
    .confusable = "density and modulus together: weigh the body",
    .parameters = gain_parameters,
    .options = one_option,
    .channels = no_channels,
    .apply = apply_overall,
    .starts = overall_starts,
    .tolerance = &Tolerances::scale,
    .is_gain = true,
    .is_scale = true,
    .in_study = {.table = InStudy::Table::all_sensors, .keys = {kGainKey}},
};

}  // namespace chladni::diagnosis
