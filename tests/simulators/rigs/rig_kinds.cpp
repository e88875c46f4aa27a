// The effects that are hidden in real rigs. Sizes are clear beside the rig's own deviations, except
// those of masses and springs, which begin at the limit.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulators/rigs/rig_recipe.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

// The rig's own deviation of a constant belongs to the size.
double relative(double now, double before) { return now / before - 1.0; }

HiddenEffect modulus(RigRecipe& recipe, RigDraw& drawn) {
  const double e = drawn.sign() * drawn.size(0.06, 0.2);
  auto& q = recipe.plate.stiffness;
  for (double* value : {&q.q11, &q.q12, &q.q22, &q.q66, &q.shear}) *value *= 1.0 + e;
  return {"", {{"relative", relative(q.q11, recipe.body.rig.body.stiffness.q11)}}, {}, {}};
}

HiddenEffect density(RigRecipe& recipe, RigDraw& drawn) {
  recipe.plate.density *= 1.0 + drawn.sign() * drawn.size(0.06, 0.2);
  return {"", {{"relative", relative(recipe.plate.density, recipe.body.rig.body.density)}}, {}, {}};
}

HiddenEffect taper(RigRecipe& recipe, RigDraw& drawn) {
  const Eigen::Vector2d slope = drawn.size(0.05, 0.15) * drawn.direction(recipe.body);
  auto& field = recipe.plate.thickness;
  const double mean = field(0, 0);
  if (field.rows() < 2 || field.cols() < 2) {
    Eigen::MatrixXd larger =
        Eigen::MatrixXd::Zero(std::max<Index>(2, field.rows()), std::max<Index>(2, field.cols()));
    larger.topLeftCorner(field.rows(), field.cols()) = field;
    field = larger;
  }
  field(1, 0) += mean * slope.x();
  field(0, 1) += mean * slope.y();
  return {"", {{"u1", field(1, 0) / mean}, {"v1", field(0, 1) / mean}}, {}, {}};
}

HiddenEffect patch(RigRecipe& recipe, RigDraw& drawn) {
  const double wide = recipe.body.rig.is_slender() ? 0.06 : 0.12;
  const double radius = recipe.body.size() * drawn.dice.between(0.6, 1.0) * wide;
  const bool soft = drawn.dice.uniform() < 0.5;
  const double change = soft ? -drawn.size(0.35, 0.85) : drawn.size(0.6, 2.5);
  const auto place = drawn.place(recipe.body, 0.3 * radius);
  recipe.plate.discs.push_back({place, radius, 1.0 + change, 1.0});
  return {"", {{"factor", change}, {"radius", radius}}, place, {}};
}

HiddenEffect point_mass(RigRecipe& recipe, RigDraw& drawn) {
  RitzPoint point;
  const double part = drawn.size(3e-3, 0.03);
  point.mass = recipe.body.mass * (drawn.mass > 0.0 ? drawn.mass : part);
  point.place = drawn.place(recipe.body, 0.02 * recipe.body.size());
  recipe.points.push_back(point);
  return {"", {{"mass", point.mass}}, point.place, {}};
}

double stiffness(const RealBody& body, double part) {
  return part * body.mass * std::pow(2.0 * pi * first_in_band(body), 2);
}

HiddenEffect ground_spring(RigRecipe& recipe, RigDraw& drawn) {
  RitzPoint point;
  point.stiffness = stiffness(recipe.body, drawn.size(0.03, 0.5));
  point.place = drawn.place(recipe.body, 0.02 * recipe.body.size());
  recipe.points.push_back(point);
  return {"", {{"stiffness", point.stiffness}}, point.place, {}};
}

HiddenEffect elastic_pad(RigRecipe& recipe, RigDraw& drawn) {
  RitzPad pad;
  pad.radius = recipe.body.size() * drawn.dice.between(0.1, 0.2);
  pad.stiffness = stiffness(recipe.body, drawn.size(0.05, 1.0));
  pad.centre = drawn.place(recipe.body, 0.05 * recipe.body.size());
  recipe.pads.push_back(pad);
  return {"", {{"stiffness", pad.stiffness}, {"radius", pad.radius}}, pad.centre, {}};
}

std::string sensor_name(const RigRecipe& recipe, Index i) {
  return recipe.channels.output_names[static_cast<std::size_t>(i)];
}

HiddenEffect sensor_gain(RigRecipe& recipe, RigDraw& drawn) {
  const Index i = drawn.sensor(recipe);
  const double factor = drawn.size(1.25, 2.0);
  recipe.output_gain(i) *= drawn.sign() > 0.0 ? factor : 1.0 / factor;
  return {"", {{"relative", recipe.output_gain(i) - 1.0}}, {}, {sensor_name(recipe, i)}};
}

HiddenEffect sensor_sign(RigRecipe& recipe, RigDraw& drawn) {
  const Index i = drawn.sensor(recipe);
  recipe.output_gain(i) *= -1.0;
  return {"", {}, {}, {sensor_name(recipe, i)}};
}

HiddenEffect swapped_sensors(RigRecipe& recipe, RigDraw& drawn) {
  const Index i = drawn.sensor(recipe);
  const Index j = drawn.sensor(recipe);
  std::swap(recipe.output_of[static_cast<std::size_t>(i)],
            recipe.output_of[static_cast<std::size_t>(j)]);
  return {"", {}, {}, {sensor_name(recipe, std::min(i, j)), sensor_name(recipe, std::max(i, j))}};
}

HiddenEffect sensor_position(RigRecipe& recipe, RigDraw& drawn) {
  const Index i = drawn.sensor(recipe);
  const Eigen::Vector2d believed = recipe.body.rig.channels.outputs.row(i).transpose();
  const double by = recipe.body.size() * drawn.size(0.04, 0.1);
  Eigen::Vector2d place = believed;
  for (int attempt = 0; attempt < 100; ++attempt) {
    place = recipe.channels.outputs.row(i).transpose() + by * drawn.direction(recipe.body);
    if (recipe.body.covers(place, 2e-3)) break;
  }
  const Eigen::Vector2d step = place - believed;
  recipe.channels.outputs.row(i) = place.transpose();
  return {"", {{"u", step.x()}, {"v", step.y()}}, {}, {sensor_name(recipe, i)}};
}

// A crack that runs across a slender body, or in any direction over a third of another.
HiddenEffect line_crack(RigRecipe& recipe, RigDraw& drawn) {
  const auto& body = recipe.body;
  const auto middle = drawn.place(body, 0.2 * body.size());
  const double angle = drawn.dice.between(0.0, pi);
  const double length = body.size() * drawn.size(0.15, 0.35);
  Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  if (body.rig.is_slender()) half = {0.0, 0.499 * body.rig.body.width};
  while (!body.covers(middle + half, 1e-6) || !body.covers(middle - half, 1e-6)) half *= 0.9;
  recipe.plate.cracks.push_back({middle - half, middle + half, 0.015 * body.size(), 0.9});
  return {"", {{"length", 2.0 * half.norm()}}, middle, {}};
}

// A modulus that differs all over, with waves that no catalogue has.
HiddenEffect patches_all_over(RigRecipe& recipe, RigDraw& drawn) {
  const double rms = drawn.size(0.08, 0.2);
  const Index across = recipe.body.rig.is_slender() ? 1 : 7;
  auto& field = recipe.plate.modulus;
  field = Eigen::MatrixXd::Zero(recipe.body.rig.is_slender() ? 10 : 7, across);
  double square = 0.0;
  for (Index i = 0; i < field.rows(); ++i) {
    for (Index j = 0; j < across && i + j < field.rows(); ++j) {
      if (i + j < 3) continue;
      field(i, j) = drawn.dice.normal();
      square += field(i, j) * field(i, j) / static_cast<double>((2 * i + 1) * (2 * j + 1));
    }
  }
  field *= rms / std::sqrt(square);
  // Legendre's polynomials are largest at the corners: the sum there stays below one.
  field *= std::min(1.0, 0.8 / field.cwiseAbs().sum());
  field(0, 0) = 1.0;
  return {"", {{"rms", rms}}, {}, {}};
}

}  // namespace

const std::vector<RealKind>& all_real_kinds() {
  static const std::vector<RealKind> kinds = {
      {"youngs_modulus", false, modulus},
      {"density", false, density},
      {"point_mass", false, point_mass},
      {"ground_spring", false, ground_spring},
      {"local_stiffness", false, patch},
      {"elastic_pad", false, elastic_pad},
      {"sensor_gain", false, sensor_gain},
      {"sensor_sign", false, sensor_sign},
      {"swapped_sensors", false, swapped_sensors},
      {"sensor_position", false, sensor_position},
      {"thickness_field", false, taper},
      {"line_crack", true, line_crack},
      {"patches_all_over", true, patches_all_over},
  };
  return kinds;
}

double RigDraw::size(double low, double high) const { return low * std::pow(high / low, severity); }

Eigen::Vector2d RigDraw::place(const RealBody& body, double margin) {
  const Eigen::Vector2d half = 0.5 * Eigen::Vector2d(body.rig.body.length, body.rig.body.width);
  const bool slender = body.rig.is_slender();
  for (int attempt = 0;; ++attempt) {
    const double x = dice.between(-half.x(), half.x());
    const double y = dice.between(-half.y(), half.y());
    const Eigen::Vector2d found(x, slender ? 0.0 : y);
    const bool inside = slender ? std::abs(x) < half.x() - margin : body.covers(found, margin);
    const bool free = attempt > 500 || std::ranges::none_of(taken_places, [&](const auto& one) {
                        return (one - found).norm() < 0.2 * body.size();
                      });
    if (!inside || !free) continue;
    taken_places.push_back(found);
    return found;
  }
}

Eigen::Vector2d RigDraw::direction(const RealBody& body) {
  const double angle = dice.between(0.0, 2.0 * pi);
  if (body.rig.is_slender()) return {angle < pi ? 1.0 : -1.0, 0.0};
  return {std::cos(angle), std::sin(angle)};
}

Index RigDraw::sensor(const RigRecipe& recipe) {
  for (;;) {
    const Index found = dice.below(recipe.channels.outputs.rows());
    if (std::ranges::find(taken_sensors, found) != taken_sensors.end()) continue;
    taken_sensors.push_back(found);
    return found;
  }
}

}  // namespace chladni::simulators
