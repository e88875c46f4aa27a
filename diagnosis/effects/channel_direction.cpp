#include <cmath>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/moved_channel.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> tilts(const Structure& /*structure*/) {
  return {{.name = "toward_u", .unit = "rad", .is_size = true, .width = 0.05, .step = 1e-5},
          {.name = "toward_v", .unit = "rad", .is_size = true, .width = 0.05, .step = 1e-5}};
}

// No option if the simulation has no motion along the surface.
template <Side side>
Index tiltable(const Structure& structure) {
  const auto& channels = channels_of<side>(structure);
  const double aside = channels.aside_u.norm() + channels.aside_v.norm();
  return aside > 1e-3 * channels.shapes.norm() ? channels.count() : 0;
}

// A channel along the surface has no motion aside (ChannelSide): no tilt of it is sought.
template <Side side>
bool is_tiltable(const Structure& structure, Index option) {
  const auto& channels = channels_of<side>(structure);
  return !channels.aside_u.row(option).isZero(0.0) || !channels.aside_v.row(option).isZero(0.0);
}

template <Side side>
void tilt(State& state, const Structure& structure, Index option, const VectorXd& x) {
  if (!is_tiltable<side>(structure, option)) return;
  const auto& channels = channels_of<side>(structure);
  const double upright = 1.0 / std::sqrt(1.0 + x.squaredNorm()) - 1.0;
  const VectorXd by = (upright * channels.shapes.row(option) +
                       (1.0 + upright) * (x(0) * channels.aside_u.row(option) +
                                          x(1) * channels.aside_v.row(option)))
                          .transpose();
  if (side == Side::sensors) {
    state.outputs.row(option) += by.transpose();
  } else {
    state.inputs.col(option) += by;
  }
}

template <Side side>
std::vector<EffectStart> upright(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (Index i = 0; i < tiltable<side>(scene.structure()); ++i) {
    if (!is_tiltable<side>(scene.structure(), i)) continue;
    starts.push_back({i, VectorXd::Zero(2)});
    for (const double by : {-0.1, 0.1}) {
      starts.push_back({i, by * VectorXd::Unit(2, 0)});
      starts.push_back({i, by * VectorXd::Unit(2, 1)});
    }
  }
  return starts;
}

constexpr InStudy turned_direction(InStudy::Table table) {
  return {.table = table, .keys = {{.key = "direction", .how = StudyKey::How::computed}}};
}

}  // namespace

constinit const Effect sensor_direction{
    .name = "sensor_direction",
    .summary = "a sensor is tilted",
    .source = "its row of the shapes along the direction turned",
    .confusable = "a sensor that is off its place: the same to first order in bending",
    .parameters = tilts,
    .options = tiltable<Side::sensors>,
    .channels = the_channel<Side::sensors>,
    .apply = tilt<Side::sensors>,
    .starts = upright<Side::sensors>,
    .error = kMovedError,
    .simpler = {{&sensor_position}},
    .in_study = turned_direction(InStudy::Table::sensors),
};
constinit const Effect actuator_direction{
    .name = "actuator_direction",
    .summary = "an actuator pushes at an angle",
    .source = "its column of the shapes along the direction turned",
    .confusable = "an actuator that is off its place: the same to first order",
    .parameters = tilts,
    .options = tiltable<Side::actuators>,
    .channels = the_channel<Side::actuators>,
    .apply = tilt<Side::actuators>,
    .starts = upright<Side::actuators>,
    .error = kMovedError,
    .simpler = {{&actuator_position}},
    .in_study = turned_direction(InStudy::Table::actuators),
};

}  // namespace chladni::diagnosis
