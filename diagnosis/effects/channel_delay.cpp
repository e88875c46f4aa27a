#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> delays(const Structure& /*structure*/) {
  return {{"delay", "s", Parameter::Scale::linear, 0.0, 2e-4, 1e-8}};
}

void delay_all(State& state, const Structure& /*structure*/, Index /*option*/, const VectorXd& x) {
  for (auto& path : state.output_paths) path.delay += x(0);
}
template <Side side>
void delay_one(State& state, const Structure& /*structure*/, Index option, const VectorXd& x) {
  paths_of<side>(state)[static_cast<std::size_t>(option)].delay += x(0);
}

// Up to a turn at the top of the band, a tenth of it apart; small ones more finely.
std::vector<EffectStart> scan(const Scene& scene, Index options) {
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
std::vector<EffectStart> one_delay(const Scene& scene) { return scan(scene, 1); }
template <Side side>
std::vector<EffectStart> each_delay(const Scene& scene) {
  return scan(scene, each_channel<side>(scene.structure()));
}

constexpr std::string_view kSource = "e^{-s tau} on the responses";

}  // namespace

const Effect delay{"delay",     "all responses are late",
                   kSource,     "low-pass (magnitude falls toward the top of the band)",
                   delays,      one_option,
                   no_channels, delay_all,
                   one_delay};
const Effect sensor_delay{"sensor_delay",
                          "a sensor is later than the others",
                          kSource,
                          "its low-pass",
                          delays,
                          each_channel<Side::sensors>,
                          the_channel<Side::sensors>,
                          delay_one<Side::sensors>,
                          each_delay<Side::sensors>};
const Effect actuator_delay{"actuator_delay",
                            "an actuator is later than the others",
                            kSource,
                            "its low-pass",
                            delays,
                            each_channel<Side::actuators>,
                            the_channel<Side::actuators>,
                            delay_one<Side::actuators>,
                            each_delay<Side::actuators>};

}  // namespace chladni::diagnosis
