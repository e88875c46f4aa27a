#include <algorithm>
#include <cmath>

#include "simulators/hidden/hidden_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

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
  const Eigen::Vector2d toward = drawn.direction();
  const Index rows = std::max<Index>(2, recipe.body.thickness.rows());
  const Index cols = std::max<Index>(2, recipe.body.thickness.cols());
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(rows, cols);
  field.topLeftCorner(recipe.body.thickness.rows(), recipe.body.thickness.cols()) =
      recipe.body.thickness;
  field(1, 0) += field(0, 0) * slope * toward.x();
  field(0, 1) += field(0, 0) * slope * toward.y();
  recipe.body.thickness = field;
  return of_body(recipe, {{"u1", slope * toward.x()}, {"v1", slope * toward.y()}});
}

HiddenEffect modulus_field(Recipe& recipe, Drawn& drawn) {
  const double slope = drawn.size(2e-3, 0.3);
  const Eigen::Vector2d toward = slope * drawn.direction();
  recipe.body.modulus = Eigen::MatrixXd::Zero(2, 2);
  recipe.body.modulus << 1.0, toward.y(), toward.x(), 0.0;
  return of_body(recipe, {{"u1", toward.x()}, {"v1", toward.y()}});
}

HiddenEffect orthotropy(Recipe& recipe, Drawn& drawn) {
  const double e = drawn.sign() * drawn.size(5e-4, 0.2);
  recipe.body.stiffness.q11 *= 1.0 + e;
  return of_body(recipe, {{"along_u", e}});
}

HiddenEffect patch(Recipe& recipe, Drawn& drawn, double change) {
  const double radius = drawn.scale.length * drawn.dice.between(0.03, 0.07);
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
  const double m = drawn.scale.mass * drawn.size(2e-3, 2.0);
  return at_point(recipe, drawn, {{}, m, 0.0, 0.0, 0.0}, {{"mass", m}});
}
HiddenEffect mass_with_inertia(Recipe& recipe, Drawn& drawn) {
  const double m = drawn.scale.mass * drawn.size(0.02, 2.0);
  const double radius = drawn.scale.length * drawn.dice.between(0.025, 0.06);
  return at_point(recipe, drawn, {{}, m, m * radius * radius, 0.0, 0.0},
                  {{"mass", m}, {"radius_of_gyration", radius}});
}
HiddenEffect ground_spring(Recipe& recipe, Drawn& drawn) {
  const double k = drawn.scale.stiffness() * drawn.size(300.0, 1e6);
  return at_point(recipe, drawn, {{}, 0.0, 0.0, k, 0.0}, {{"stiffness", k}});
}
HiddenEffect ground_damper(Recipe& recipe, Drawn& drawn) {
  const double c = drawn.scale.damping() * drawn.size(0.2, 200.0);
  return at_point(recipe, drawn, {{}, 0.0, 0.0, 0.0, c}, {{"damping", c}});
}

HiddenEffect pad(Recipe& recipe, Drawn& drawn) {
  RitzPad one;
  one.stiffness = drawn.scale.stiffness() * drawn.size(2e4, 4e6);
  one.radius = drawn.dice.between(0.08, 0.15);
  one.centre = drawn.place(0.05);
  recipe.pads.push_back(one);
  return {"", {{"stiffness", one.stiffness}, {"radius", one.radius}}, one.centre, {}};
}
HiddenEffect resonator(Recipe& recipe, Drawn& drawn) {
  RitzResonator one;
  one.mass = drawn.scale.mass * drawn.size(1e-3, 0.5);
  one.frequency_hz = drawn.scale.frequency * 60.0 * std::pow(800.0 / 60.0, drawn.dice.uniform());
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
  one.mass = drawn.scale.mass * 2e4 / drawn.size(1.0, 1000.0);
  one.frequency_hz = drawn.scale.frequency * 25.0 * std::pow(300.0 / 25.0, drawn.dice.uniform());
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

}  // namespace

const std::vector<HiddenKind>& body_kinds() {
  static const std::vector<HiddenKind> kinds = {
      {"youngs_modulus", false, modulus},
      {"density", false, density},
      {"thickness", false, thickness},
      {"taper", false, taper},
      {"modulus_field", false, modulus_field},
      {"orthotropy", false, orthotropy},
      {"local_softening", false, softening},
      {"local_stiffening", false, stiffening},
      {"point_mass", false, point_mass},
      {"mass_with_inertia", false, mass_with_inertia},
      {"ground_spring", false, ground_spring},
      {"ground_damper", false, ground_damper},
      {"resonator", false, resonator},
      {"frame", false, frame},
      {"modal_damping", false, modal_damping_level},
      {"hysteretic_damping", false, hysteretic},
      {"size_error", false, size_error},
      {"modes_above", false, yielding_above},
      {"suspension", false, suspension},
      {"drift", false, drift},
      {"elastic_pad", false, pad},
  };
  return kinds;
}

}  // namespace chladni::simulators
