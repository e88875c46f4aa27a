#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/moved_channel.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> offsets(const Structure& structure) {
  std::vector<Parameter> both{{"u", "m", Parameter::Scale::linear, 0.0, 0.01, 1e-5}};
  const bool wide = !structure.outputs.slope_v.isZero(0.0) || !structure.inputs.slope_v.isZero(0.0);
  if (wide) both.push_back({"v", "m", Parameter::Scale::linear, 0.0, 0.01, 1e-5});
  return both;
}

template <Side side>
void move(State& state, const Structure& structure, Index option, const VectorXd& x) {
  const Eigen::Vector2d by_place(x(0), x.size() > 1 ? x(1) : 0.0);
  const auto change = channel_change(structure, channels_of<side>(structure), option, by_place);
  move_channel(state, side, option, change);
}

template <Side side>
std::vector<EffectStart> moves(const Scene& scene) {
  std::vector<EffectStart> starts;
  const auto n = static_cast<Index>(offsets(scene.structure()).size());
  for (Index i = 0; i < channels_of<side>(scene.structure()).count(); ++i) {
    starts.push_back({i, VectorXd::Zero(n)});
    for (Index axis = 0; axis < n; ++axis) {
      for (const double by : {-0.012, -0.004, -0.001, 0.001, 0.004, 0.012}) {
        starts.push_back({i, by * VectorXd::Unit(n, axis)});
      }
    }
  }
  return starts;
}

template <Side side>
Index all(const Structure& structure) {
  return channels_of<side>(structure).count();
}

}  // namespace

const Effect sensor_position{
    .name = "sensor_position",
    .summary = "a sensor looks at another point than it says",
    .source = "its row of the shapes at the place moved",
    .confusable = "a tilted sensor (the same to first order), its gain",
    .parameters = offsets,
    .options = all<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = move<Side::sensors>,
    .starts = moves<Side::sensors>,
    .error = kMovedError,
};
const Effect actuator_position{
    .name = "actuator_position",
    .summary = "an actuator pushes at another point than it says",
    .source = "its column of the shapes at the place moved",
    .confusable = "a tilted actuator (the same to first order), its gain",
    .parameters = offsets,
    .options = all<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = move<Side::actuators>,
    .starts = moves<Side::actuators>,
    .error = kMovedError,
};

}  // namespace chladni::diagnosis
