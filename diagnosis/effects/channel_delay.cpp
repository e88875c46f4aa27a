#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The prior is that of amplifiers and converters, whatever the body is.
std::vector<Parameter> delays(const Structure& /*structure*/) {
  return {{.name = "delay", .unit = "s", .is_size = true, .width = 2e-4, .step = 1e-8}};
}

void delay_all(State& state, const Structure& /*structure*/, Index /*option*/, const VectorXd& x) {
  for (auto& path : state.output_paths) path.delay += x(0);
}
template <Side side>
void delay_one(State& state, const Structure& /*structure*/, Index option, const VectorXd& x) {
  paths_of<side>(state)[static_cast<std::size_t>(option)].delay += x(0);
}

// Up to ±1 period at the top of the band, in steps of a tenth; finer steps for small delays.
std::vector<EffectStart> delay_scan(const Scene& scene, Index options) {
  std::vector<EffectStart> starts;
  for (Index option = 0; option < options; ++option) {
    for (int n = -10; n <= 10; ++n) {
      starts.push_back({option, VectorXd::Constant(1, 0.1 * n / scene.high_hz())});
    }
    for (double turn = 1e-4; turn < 0.06; turn *= 2.0) {
      for (const double sign : {-1.0, 1.0}) {
        starts.push_back({option, VectorXd::Constant(1, sign * turn / scene.high_hz())});
      }
    }
  }
  return starts;
}
std::vector<EffectStart> one_delay(const Scene& scene) { return delay_scan(scene, 1); }
template <Side side>
std::vector<EffectStart> each_delay(const Scene& scene) {
  return delay_scan(scene, each_channel<side>(scene.structure()));
}

constexpr StudyKey kDelayKey{"delay", "delay", "s", StudyKey::How::plus};
constexpr std::string_view kDelaySource = "e^{-s tau} on the responses";

}  // namespace

constinit const Effect delay{
    .name = "delay",
    .summary = "all responses are late",
    .source = kDelaySource,
    .confusable = "low-pass (magnitude falls toward the top of the band)",
    .parameters = delays,
    .options = one_option,
    .channels = no_channels,
    .apply = delay_all,
    .starts = one_delay,
    .tolerance = &Tolerances::delay,
    .in_study = {.table = InStudy::Table::all_sensors, .keys = {kDelayKey}},
};
constinit const Effect sensor_delay{
    .name = "sensor_delay",
    .summary = "a sensor is later than the others",
    .source = kDelaySource,
    .confusable = "its low-pass",
    .parameters = delays,
    .options = each_channel<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = delay_one<Side::sensors>,
    .starts = each_delay<Side::sensors>,
    .in_study = {.table = InStudy::Table::sensors, .keys = {kDelayKey}},
};
constinit const Effect actuator_delay{
    .name = "actuator_delay",
    .summary = "an actuator is later than the others",
    .source = kDelaySource,
    .confusable = "its low-pass",
    .parameters = delays,
    .options = each_channel<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = delay_one<Side::actuators>,
    .starts = each_delay<Side::actuators>,
    .in_study = {.table = InStudy::Table::actuators, .keys = {kDelayKey}},
};

}  // namespace chladni::diagnosis
