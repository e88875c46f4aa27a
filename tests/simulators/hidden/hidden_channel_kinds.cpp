#include <algorithm>

#include "base/index.h"
#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

// The records, names and places of one side.
struct Side {
  std::vector<ChannelFilter>& filters;
  const std::vector<std::string>& names;
  Eigen::MatrixX2d& places;
  std::vector<Index>& of;
  Eigen::MatrixX2d& tilts;
};
Side sensors(Recipe& recipe) {
  return {recipe.outputs, recipe.channels.output_names, recipe.channels.outputs, recipe.output_of,
          recipe.output_tilts};
}
Side actuators(Recipe& recipe) {
  return {recipe.inputs, recipe.channels.input_names, recipe.channels.inputs, recipe.input_of,
          recipe.input_tilts};
}
using OfSide = Side (*)(Recipe&);

template <OfSide side>
HiddenEffect carried(Recipe& recipe, Drawn& drawn) {
  const auto& places = side(recipe).places;
  const double m = drawn.scale.mass * drawn.size(0.02, 2.0) / static_cast<double>(places.rows());
  for (const auto place : places.rowwise()) {
    recipe.points.push_back({place.transpose(), m, 0.0, 0.0, 0.0});
  }
  return {"", {{"mass", m}}, {}, {}};
}
template <OfSide side>
HiddenEffect gain(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double g = drawn.sign() * drawn.size(1e-3, 0.4);
  all.filters[at(i)].gain *= 1.0 + g;
  return {"", {{"relative", g}}, {}, {all.names[at(i)]}};
}
template <OfSide side>
HiddenEffect turned(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  all.filters[at(i)].gain *= -1.0;
  return {"", {}, {}, {all.names[at(i)]}};
}
template <OfSide side>
HiddenEffect moved(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double by = drawn.scale.length * drawn.size(2e-4, 0.03);
  const Eigen::RowVector2d step = by * drawn.direction().transpose();
  all.places.row(i) += step;
  return {"", {{"u", step(0)}, {"v", step(1)}}, {}, {all.names[at(i)]}};
}
template <OfSide side>
HiddenEffect tilted(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double by = drawn.size(0.02, 0.2);
  const Eigen::RowVector2d toward = by * drawn.direction().transpose();
  all.tilts.row(i) += toward;
  return {"", {{"toward_u", toward(0)}, {"toward_v", toward(1)}}, {}, {all.names[at(i)]}};
}
template <OfSide side>
HiddenEffect swapped(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  drawn.taken_channels.push_back(all.names[at(i)]);
  const Index j = drawn.channel(all.names);
  std::swap(all.of[at(i)], all.of[at(j)]);
  return {"", {}, {}, {all.names[at(std::min(i, j))], all.names[at(std::max(i, j))]}};
}
template <OfSide side>
HiddenEffect late(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double delay = drawn.size(5e-7, 2e-4) / drawn.scale.frequency;
  all.filters[at(i)].delay_s += delay;
  return {"", {{"delay", delay}}, {}, {all.names[at(i)]}};
}
HiddenEffect all_late(Recipe& recipe, Drawn& drawn) {
  const double delay = drawn.size(2e-7, 2e-4) / drawn.scale.frequency;
  for (auto& filter : recipe.outputs) filter.delay_s += delay;
  return {"", {{"delay", delay}}, {}, {}};
}
template <OfSide side>
HiddenEffect low_pass(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double corner = drawn.scale.frequency * 2e8 / drawn.size(1e3, 5e5);
  all.filters[at(i)].corner_hz = corner;
  return {"", {{"frequency", corner}}, {}, {all.names[at(i)]}};
}
HiddenEffect all_low_pass(Recipe& recipe, Drawn& drawn) {
  const double corner = drawn.scale.frequency * 2e8 / drawn.size(1e3, 5e5);
  for (auto& filter : recipe.outputs) filter.corner_hz = corner;
  return {"", {{"frequency", corner}}, {}, {}};
}
HiddenEffect all_gains(Recipe& recipe, Drawn& drawn) {
  const double g = drawn.sign() * drawn.size(1e-3, 0.4);
  for (auto& filter : recipe.outputs) filter.gain *= 1.0 + g;
  return {"", {{"relative", g}}, {}, {}};
}

HiddenEffect quantity(Recipe& recipe, Drawn& drawn) {
  const Index i = drawn.channel(recipe.channels.output_names);
  recipe.outputs[at(i)].power = drawn.dice.uniform() < 0.7 ? 1 : 2;
  const auto power = static_cast<double>(recipe.outputs[at(i)].power);
  return {"", {{"power", power}}, {}, {recipe.channels.output_names[at(i)]}};
}
HiddenEffect unit(Recipe& recipe, Drawn& drawn) {
  const Index i = drawn.channel(recipe.channels.output_names);
  const double factors[] = {1.0 / 9.80665, 9.80665, 1e3};
  const double factor = factors[at(drawn.dice.below(3))];
  recipe.outputs[at(i)].gain *= factor;
  return {"", {{"factor", factor}}, {}, {recipe.channels.output_names[at(i)]}};
}

template <OfSide side>
HiddenEffect spoilt(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  drawn.taken_channels.push_back(all.names[at(i)]);
  const Index by = drawn.channel(all.names);
  const double share = drawn.sign() * drawn.size(1e-3, 0.2);
  const bool output = &all.filters == &recipe.outputs;
  (output ? recipe.output_mix(i, by) : recipe.input_mix(by, i)) = share;
  return {"", {{"share", share}}, {}, {all.names[at(i)], all.names[at(by)]}};
}

}  // namespace

const std::vector<HiddenKind>& channel_kinds() {
  static const std::vector<HiddenKind> kinds = {
      {"sensor_masses", false, carried<sensors>},
      {"actuator_masses", false, carried<actuators>},
      {"sensor_gain", false, gain<sensors>},
      {"actuator_gain", false, gain<actuators>},
      {"overall_gain", false, all_gains},
      {"sensor_position", false, moved<sensors>},
      {"actuator_position", false, moved<actuators>},
      {"sensor_direction", false, tilted<sensors>},
      {"actuator_direction", false, tilted<actuators>},
      {"sensor_sign", false, turned<sensors>},
      {"actuator_sign", false, turned<actuators>},
      {"swapped_sensors", false, swapped<sensors>},
      {"swapped_actuators", false, swapped<actuators>},
      {"delay", false, all_late},
      {"sensor_delay", false, late<sensors>},
      {"actuator_delay", false, late<actuators>},
      {"low_pass", false, all_low_pass},
      {"sensor_low_pass", false, low_pass<sensors>},
      {"actuator_low_pass", false, low_pass<actuators>},
      {"sensor_quantity", false, quantity},
      {"sensor_unit", false, unit},
      {"sensor_crosstalk", false, spoilt<sensors>},
      {"actuator_crosstalk", false, spoilt<actuators>},
  };
  return kinds;
}

}  // namespace chladni::simulators
