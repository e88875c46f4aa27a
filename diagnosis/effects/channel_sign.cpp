#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

// One option per channel. A single response has one option only, for its sensor, because the sign
// of the actuator has the same effect.
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

constexpr InStudy turned_direction(InStudy::Table table) {
  return {.table = table, .keys = {{.key = "direction", .how = StudyKey::How::computed}}};
}

}  // namespace

constinit const Effect sensor_sign{
    .name = "sensor_sign",
    .summary = "a sensor is wired or mounted the wrong way round",
    .source = "a row of the responses turned",
    .confusable = "a gain of -200 %: the same",
    .parameters = no_sizes,
    .options = turnable<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = turn<Side::sensors>,
    .starts = turned<Side::sensors>,
    .in_study = turned_direction(InStudy::Table::sensors),
};
constinit const Effect actuator_sign{
    .name = "actuator_sign",
    .summary = "an actuator pushes the other way",
    .source = "a column of the responses turned",
    .confusable = "a gain of -200 %: the same",
    .parameters = no_sizes,
    .options = turnable<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = turn<Side::actuators>,
    .starts = turned<Side::actuators>,
    .in_study = turned_direction(InStudy::Table::actuators),
};

}  // namespace chladni::diagnosis
