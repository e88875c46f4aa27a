#include <cmath>
#include <numbers>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The prior is that of amplifiers and filters, whatever the body is.
std::vector<Parameter> corner(const Structure& /*structure*/) {
  return {{.name = "frequency",
           .unit = "Hz",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::frequency,
           .is_size = true,
           .centre = std::log(5e3),
           .width = 2.0,
           .step = 1e-4}};
}

double lag(const VectorXd& x) { return std::exp(-x(0)) / (2.0 * std::numbers::pi); }

void filter_all(State& state, const Structure& /*structure*/, Index /*option*/, const VectorXd& x) {
  for (auto& path : state.output_paths) path.lag += lag(x);
}
template <Side side>
void filter_one(State& state, const Structure& /*structure*/, Index option, const VectorXd& x) {
  paths_of<side>(state)[static_cast<std::size_t>(option)].lag += lag(x);
}

// Corners from a third of the top of the band to a thousand times it.
std::vector<EffectStart> corner_scan(const Scene& scene, Index options) {
  std::vector<EffectStart> starts;
  for (Index option = 0; option < options; ++option) {
    for (double times = 0.3; times < 1e3; times *= 2.0) {
      starts.push_back({option, VectorXd::Constant(1, std::log(times * scene.high_hz()))});
    }
  }
  return starts;
}
std::vector<EffectStart> one_corner(const Scene& scene) { return corner_scan(scene, 1); }
template <Side side>
std::vector<EffectStart> each_corner(const Scene& scene) {
  return corner_scan(scene, each_channel<side>(scene.structure()));
}

constexpr StudyKey kLowPassKey{"low_pass", "frequency", "Hz", StudyKey::How::plus_lag};
constexpr std::string_view kLowPassSource = "1 / (1 + s / omega_c) on the responses";

}  // namespace

constinit const Effect low_pass{
    .name = "low_pass",
    .summary = "amplifier or filter in all channels",
    .source = kLowPassSource,
    .confusable = "delay (leaves the magnitude)",
    .parameters = corner,
    .options = one_option,
    .channels = no_channels,
    .apply = filter_all,
    .starts = one_corner,
    .in_study = {.table = InStudy::Table::all_sensors, .keys = {kLowPassKey}},
};
constinit const Effect sensor_low_pass{
    .name = "sensor_low_pass",
    .summary = "a sensor is slow",
    .source = kLowPassSource,
    .confusable = "its delay",
    .parameters = corner,
    .options = each_channel<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = filter_one<Side::sensors>,
    .starts = each_corner<Side::sensors>,
    .in_study = {.table = InStudy::Table::sensors, .keys = {kLowPassKey}},
};
constinit const Effect actuator_low_pass{
    .name = "actuator_low_pass",
    .summary = "an actuator or its amplifier is slow",
    .source = kLowPassSource,
    .confusable = "its delay",
    .parameters = corner,
    .options = each_channel<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = filter_one<Side::actuators>,
    .starts = each_corner<Side::actuators>,
    .in_study = {.table = InStudy::Table::actuators, .keys = {kLowPassKey}},
};

}  // namespace chladni::diagnosis
