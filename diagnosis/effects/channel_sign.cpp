#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

std::vector<Parameter> none(const Structure& /*structure*/) { return {}; }

// One per channel. Where a side has one, turning it turns all: of a single response the sensor.
template <Side side>
Eigen::Index turnable(const Structure& structure) {
  const Eigen::Index count = channels_of<side>(structure).count();
  const bool single = side == Side::actuators && count == 1 && structure.output_count() == 1;
  return single ? 0 : count;
}

template <Side side>
void turn(State& state, const Structure& /*structure*/, Eigen::Index option,
          const Eigen::VectorXd& /*x*/) {
  paths_of<side>(state)[static_cast<std::size_t>(option)].gain *= -1.0;
}

template <Side side>
std::vector<EffectStart> turned(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (Eigen::Index i = 0; i < turnable<side>(scene.structure()); ++i) {
    if (channel_factor<side>(scene, i) < 0.0) starts.push_back({i, {}});
  }
  return starts;
}

}  // namespace

const Effect sensor_sign{"sensor_sign",
                         "a sensor is wired or mounted the wrong way round",
                         "a row of the responses turned",
                         "a gain of -200 %: the same",
                         none,
                         turnable<Side::sensors>,
                         the_channel<Side::sensors>,
                         turn<Side::sensors>,
                         turned<Side::sensors>};
const Effect actuator_sign{"actuator_sign",
                           "an actuator pushes the other way",
                           "a column of the responses turned",
                           "a gain of -200 %: the same",
                           none,
                           turnable<Side::actuators>,
                           the_channel<Side::actuators>,
                           turn<Side::actuators>,
                           turned<Side::actuators>};

}  // namespace chladni::diagnosis
