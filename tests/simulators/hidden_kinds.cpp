#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulators/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

HiddenEffect of_body(Recipe& recipe, std::map<std::string, double> size) {
  recipe.same_body = false;
  return {"", std::move(size), {}, {}};
}

HiddenEffect modulus(Recipe& recipe, Drawn& drawn) {
  const double e = drawn.sign() * drawn.size(2e-4, 0.15);
  auto& q = recipe.body.stiffness;
  for (double* value : {&q.q11, &q.q12, &q.q22, &q.q66, &q.shear}) *value *= 1.0 + e;
  return of_body(recipe, {{"relative", e}});
}

HiddenEffect density(Recipe& recipe, Drawn& drawn) {
  const double r = drawn.sign() * drawn.size(2e-4, 0.15);
  recipe.body.density *= 1.0 + r;
  return of_body(recipe, {{"relative", r}});
}

HiddenEffect thickness(Recipe& recipe, Drawn& drawn) {
  const double t = drawn.sign() * drawn.size(1e-4, 0.08);
  recipe.body.thickness *= 1.0 + t;
  return of_body(recipe, {{"relative", t}});
}

HiddenEffect taper(Recipe& recipe, Drawn& drawn) {
  const double slope = drawn.size(5e-4, 0.08);
  const double angle = drawn.dice.between(0.0, 2.0 * pi);
  const Index rows = std::max<Index>(2, recipe.body.thickness.rows());
  const Index cols = std::max<Index>(2, recipe.body.thickness.cols());
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(rows, cols);
  field.topLeftCorner(recipe.body.thickness.rows(), recipe.body.thickness.cols()) =
      recipe.body.thickness;
  field(1, 0) += field(0, 0) * slope * std::cos(angle);
  field(0, 1) += field(0, 0) * slope * std::sin(angle);
  recipe.body.thickness = field;
  return of_body(recipe, {{"u1", slope * std::cos(angle)}, {"v1", slope * std::sin(angle)}});
}

HiddenEffect orthotropy(Recipe& recipe, Drawn& drawn) {
  const double e = drawn.sign() * drawn.size(5e-4, 0.2);
  recipe.body.stiffness.q11 *= 1.0 + e;
  return of_body(recipe, {{"along_u", e}});
}

HiddenEffect patch(Recipe& recipe, Drawn& drawn, double change) {
  const double radius = drawn.dice.between(0.03, 0.07);
  const Eigen::Vector2d place = drawn.place(0.03);
  recipe.body.discs.push_back({place, radius, 1.0 + change, 1.0});
  auto effect = of_body(recipe, {{"factor", change}, {"radius", radius}});
  effect.place = place;
  return effect;
}
HiddenEffect softening(Recipe& recipe, Drawn& drawn) {
  return patch(recipe, drawn, -drawn.size(0.01, 0.9));
}
HiddenEffect stiffening(Recipe& recipe, Drawn& drawn) {
  return patch(recipe, drawn, drawn.size(0.01, 1.5));
}

HiddenEffect at_point(Recipe& recipe, Drawn& drawn, RitzPoint point,
                      std::map<std::string, double> size) {
  point.place = drawn.place();
  recipe.points.push_back(point);
  return {"", std::move(size), point.place, {}};
}
HiddenEffect point_mass(Recipe& recipe, Drawn& drawn) {
  const double m = drawn.size(2e-3, 2.0);
  return at_point(recipe, drawn, {{}, m, 0.0, 0.0, 0.0}, {{"mass", m}});
}
HiddenEffect mass_with_inertia(Recipe& recipe, Drawn& drawn) {
  const double m = drawn.size(0.02, 2.0);
  const double radius = drawn.dice.between(0.025, 0.06);
  return at_point(recipe, drawn, {{}, m, m * radius * radius, 0.0, 0.0},
                  {{"mass", m}, {"radius_of_gyration", radius}});
}
HiddenEffect ground_spring(Recipe& recipe, Drawn& drawn) {
  const double k = drawn.size(300.0, 1e6);
  return at_point(recipe, drawn, {{}, 0.0, 0.0, k, 0.0}, {{"stiffness", k}});
}
HiddenEffect ground_damper(Recipe& recipe, Drawn& drawn) {
  const double c = drawn.size(0.2, 200.0);
  return at_point(recipe, drawn, {{}, 0.0, 0.0, 0.0, c}, {{"damping", c}});
}

HiddenEffect resonator(Recipe& recipe, Drawn& drawn) {
  RitzResonator one;
  one.mass = drawn.size(1e-3, 0.5);
  one.frequency_hz = 60.0 * std::pow(800.0 / 60.0, drawn.dice.uniform());
  one.damping_ratio = drawn.dice.between(0.005, 0.03);
  one.place = drawn.place();
  recipe.resonators.push_back(one);
  return {
      "",
      {{"mass", one.mass}, {"frequency", one.frequency_hz}, {"damping_ratio", one.damping_ratio}},
      one.place,
      {}};
}

HiddenEffect frame(Recipe& recipe, Drawn& drawn) {
  RitzFrame one;
  one.mass = 2e4 / drawn.size(1.0, 1000.0);
  one.frequency_hz = 25.0 * std::pow(300.0 / 25.0, drawn.dice.uniform());
  one.damping_ratio = drawn.dice.between(0.01, 0.04);
  recipe.frame = one;
  return {
      "",
      {{"mass", one.mass}, {"frequency", one.frequency_hz}, {"damping_ratio", one.damping_ratio}},
      {},
      {}};
}

HiddenEffect modal_damping_level(Recipe& recipe, Drawn& drawn) {
  const double factor = std::exp(drawn.sign() * drawn.size(0.01, 1.2));
  recipe.damping_factor *= factor;
  return {"", {{"factor", factor}}, {}, {}};
}
HiddenEffect hysteretic(Recipe& recipe, Drawn& /*drawn*/) {
  recipe.hysteretic = true;
  return {"", {{"share", 1.0}}, {}, {}};
}

// On one side: its records, its names, its places.
struct Side {
  std::vector<ChannelFilter>& filters;
  const std::vector<std::string>& names;
  Eigen::MatrixX2d& places;
  std::vector<Index>& of;
};
Side sensors(Recipe& recipe) {
  return {recipe.outputs, recipe.channels.output_names, recipe.channels.outputs, recipe.output_of};
}
Side actuators(Recipe& recipe) {
  return {recipe.inputs, recipe.channels.input_names, recipe.channels.inputs, recipe.input_of};
}
using OfSide = Side (*)(Recipe&);

template <OfSide side>
HiddenEffect carried(Recipe& recipe, Drawn& drawn) {
  const auto& places = side(recipe).places;
  const double m = drawn.size(0.02, 2.0) / static_cast<double>(places.rows());
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
  const double by = drawn.size(2e-4, 0.03);
  const double angle = drawn.dice.between(0.0, 2.0 * pi);
  const Eigen::RowVector2d step(by * std::cos(angle), by * std::sin(angle));
  all.places.row(i) += step;
  return {"", {{"u", step(0)}, {"v", step(1)}}, {}, {all.names[at(i)]}};
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
  const double delay = drawn.size(5e-7, 2e-4);
  all.filters[at(i)].delay_s += delay;
  return {"", {{"delay", delay}}, {}, {all.names[at(i)]}};
}
HiddenEffect all_late(Recipe& recipe, Drawn& drawn) {
  const double delay = drawn.size(2e-7, 2e-4);
  for (auto& filter : recipe.outputs) filter.delay_s += delay;
  return {"", {{"delay", delay}}, {}, {}};
}
template <OfSide side>
HiddenEffect low_pass(Recipe& recipe, Drawn& drawn) {
  const Side all = side(recipe);
  const Index i = drawn.channel(all.names);
  const double corner = 2e8 / drawn.size(1e3, 5e5);
  all.filters[at(i)].corner_hz = corner;
  return {"", {{"frequency", corner}}, {}, {all.names[at(i)]}};
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

HiddenEffect size_error(Recipe& recipe, Drawn& drawn) {
  const double s = drawn.sign() * drawn.size(2e-4, 0.03);
  recipe.body.length *= 1.0 + s;
  recipe.body.width *= 1.0 + s;
  return of_body(recipe, {{"relative", s}});
}
HiddenEffect yielding_above(Recipe& recipe, Drawn& drawn) {
  recipe.yielding = drawn.size(0.05, 8.0);
  return {"", {{"relative", recipe.yielding}}, {}, {}};
}
HiddenEffect suspension(Recipe& recipe, Drawn& drawn) {
  recipe.held_hz = drawn.size(1.5, 60.0);
  recipe.held_damping = drawn.dice.between(0.02, 0.3);
  return {"", {{"frequency", recipe.held_hz}, {"damping_ratio", recipe.held_damping}}, {}, {}};
}
HiddenEffect drift(Recipe& recipe, Drawn& drawn) {
  const double by = drawn.sign() * drawn.size(2e-4, 0.01);
  const Index q = recipe.channels.inputs.rows();
  recipe.stiffening = Eigen::VectorXd::LinSpaced(q, -0.5 * by, 0.5 * by);
  return {"", {{"first_to_last", by}}, {}, {}};
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

HiddenEffect pad(Recipe& recipe, Drawn& drawn) {
  RitzPad one;
  one.stiffness = drawn.size(2e4, 4e6);
  one.radius = drawn.dice.between(0.08, 0.15);
  one.centre = drawn.place(0.05);
  recipe.pads.push_back(one);
  return {"", {{"stiffness", one.stiffness}, {"radius", one.radius}}, one.centre, {}};
}
HiddenEffect notch(Recipe& recipe, Drawn& drawn) {
  const Index i = drawn.channel(recipe.channels.output_names);
  auto& filter = recipe.outputs[at(i)];
  filter.notch_hz = drawn.dice.between(150.0, 700.0);
  filter.notch_damping = drawn.size(0.01, 0.5);
  return {"",
          {{"frequency", filter.notch_hz}, {"damping_ratio", filter.notch_damping}},
          {},
          {recipe.channels.output_names[at(i)]}};
}
HiddenEffect rising_damping(Recipe& recipe, Drawn& drawn) {
  recipe.damping_exponent = drawn.size(0.3, 1.5);
  return {"", {{"exponent", recipe.damping_exponent}}, {}, {}};
}
HiddenEffect crosstalk(Recipe& recipe, Drawn& drawn) {
  const double x = drawn.size(0.01, 0.15);
  const auto mix = [&](Eigen::MatrixXd& matrix) {
    matrix += x * drawn.dice.normal(matrix.rows(), matrix.cols());
    matrix.diagonal().setOnes();
  };
  mix(recipe.output_mix);
  mix(recipe.input_mix);
  return {"", {{"rms", x}}, {}, {}};
}
HiddenEffect crack(Recipe& recipe, Drawn& drawn) {
  const Eigen::Vector2d middle = drawn.place(0.1);
  const double length = drawn.size(0.06, 0.25);
  const double angle = drawn.dice.between(0.0, pi);
  const Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d rim(0.295, 0.295);
  const auto within = [&rim](const Eigen::Vector2d& end) -> Eigen::Vector2d {
    return end.cwiseMin(rim).cwiseMax(-rim);
  };
  recipe.body.cracks.push_back({within(middle - half), within(middle + half), 0.01, 0.9});
  auto effect = of_body(recipe, {{"length", length}});
  effect.place = middle;
  return effect;
}
HiddenEffect six_masses(Recipe& recipe, Drawn& drawn) {
  const double total = drawn.size(0.1, 3.0);
  for (int i = 0; i < 6; ++i) {
    const double m = total / 6.0 * drawn.dice.between(0.4, 1.6);
    const Eigen::Vector2d place = drawn.place();
    drawn.taken_places.push_back(place);
    recipe.points.push_back({place, m, 0.0, 0.0, 0.0});
  }
  return {"", {{"mass", total}}, {}, {}};
}
HiddenEffect other_plate(Recipe& recipe, Drawn& drawn) {
  auto& body = recipe.body;
  body.length = drawn.dice.between(0.35, 0.8);
  body.width = drawn.dice.between(0.35, 0.8);
  body.thickness *= drawn.dice.between(0.4, 1.5);
  const bool steel = drawn.dice.uniform() < 0.5;
  body.stiffness = isotropic_plane(steel ? 205e9 : 70e9, 0.3);
  body.density = steel ? 7850.0 : 2700.0;
  for (auto* places : {&recipe.channels.outputs, &recipe.channels.inputs}) {
    places->col(0) *= body.length / 0.6;
    places->col(1) *= body.width / 0.6;
  }
  return of_body(recipe, {{"length", body.length}, {"width", body.width}});
}
HiddenEffect in_plane_mode(Recipe& recipe, Drawn& drawn) {
  recipe.foreign_hz = drawn.dice.between(150.0, 750.0);
  recipe.foreign_damping = 0.005;
  const double size = 0.22 * drawn.size(0.02, 0.5);  // of the plate's own shapes
  recipe.foreign_outputs = size * drawn.dice.normal(4, 1);
  recipe.foreign_inputs = size * drawn.dice.normal(13, 1);
  return {"", {{"frequency", recipe.foreign_hz}, {"relative", size / 0.22}}, {}, {}};
}

}  // namespace

const std::vector<HiddenKind>& all_hidden_kinds() {
  static const std::vector<HiddenKind> kinds = {
      {"youngs_modulus", false, modulus},
      {"density", false, density},
      {"thickness", false, thickness},
      {"taper", false, taper},
      {"orthotropy", false, orthotropy},
      {"local_softening", false, softening},
      {"local_stiffening", false, stiffening},
      {"point_mass", false, point_mass},
      {"mass_with_inertia", false, mass_with_inertia},
      {"sensor_masses", false, carried<sensors>},
      {"actuator_masses", false, carried<actuators>},
      {"ground_spring", false, ground_spring},
      {"ground_damper", false, ground_damper},
      {"resonator", false, resonator},
      {"frame", false, frame},
      {"modal_damping", false, modal_damping_level},
      {"hysteretic_damping", false, hysteretic},
      {"sensor_gain", false, gain<sensors>},
      {"actuator_gain", false, gain<actuators>},
      {"sensor_position", false, moved<sensors>},
      {"actuator_position", false, moved<actuators>},
      {"sensor_sign", false, turned<sensors>},
      {"actuator_sign", false, turned<actuators>},
      {"swapped_sensors", false, swapped<sensors>},
      {"swapped_actuators", false, swapped<actuators>},
      {"delay", false, all_late},
      {"sensor_delay", false, late<sensors>},
      {"actuator_delay", false, late<actuators>},
      {"sensor_low_pass", false, low_pass<sensors>},
      {"actuator_low_pass", false, low_pass<actuators>},
      {"sensor_quantity", false, quantity},
      {"sensor_unit", false, unit},
      {"size_error", false, size_error},
      {"modes_above", false, yielding_above},
      {"suspension", false, suspension},
      {"drift", false, drift},
      {"sensor_crosstalk", false, spoilt<sensors>},
      {"actuator_crosstalk", false, spoilt<actuators>},
      {"elastic_pad", true, pad},
      {"sensor_notch", true, notch},
      {"rising_damping", true, rising_damping},
      {"crosstalk", true, crosstalk},
      {"line_crack", true, crack},
      {"six_masses", true, six_masses},
      {"other_plate", true, other_plate},
      {"in_plane_mode", true, in_plane_mode},
  };
  return kinds;
}

}  // namespace chladni::simulators
