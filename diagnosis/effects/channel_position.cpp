#include "diagnosis/effects/body_scale.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/moved_channel.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> offsets(const Structure& structure) {
  const auto along = [&](std::string_view axis) {
    return Parameter{.name = axis,
                     .unit = "m",
                     .role = Parameter::Role::offset,
                     .is_size = true,
                     .width = 0.01 * body_scale(structure),
                     .step = place_step(structure)};
  };
  std::vector<Parameter> both{along("u")};
  const bool wide = !structure.outputs.slope_v.isZero(0.0) || !structure.inputs.slope_v.isZero(0.0);
  if (wide) both.push_back(along("v"));
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
  const double scale = body_scale(scene.structure());
  const auto n = static_cast<Index>(offsets(scene.structure()).size());
  for (Index i = 0; i < channels_of<side>(scene.structure()).count(); ++i) {
    starts.push_back({i, VectorXd::Zero(n)});
    for (Index axis = 0; axis < n; ++axis) {
      for (const double by : {-0.012, -0.004, -0.001, 0.001, 0.004, 0.012}) {
        starts.push_back({i, scale * by * VectorXd::Unit(n, axis)});
      }
    }
  }
  return starts;
}

template <Side side>
Index all(const Structure& structure) {
  return channels_of<side>(structure).count();
}

constexpr InStudy moved_place(InStudy::Table table) {
  return {.table = table, .keys = {{.key = "at", .how = StudyKey::How::computed}}};
}

}  // namespace

constinit const Effect sensor_position{
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
    .tolerance = &Tolerances::position,
    .in_study = moved_place(InStudy::Table::sensors),
};
constinit const Effect actuator_position{
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
    .tolerance = &Tolerances::position,
    .in_study = moved_place(InStudy::Table::actuators),
};

}  // namespace chladni::diagnosis
