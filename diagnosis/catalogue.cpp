#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

// Causes in a channel before those in the body: they are the cheaper ones to look after.
constexpr std::array kAll{
    &sensor_sign,
    &actuator_sign,
    &swapped_sensors,
    &swapped_actuators,
    &sensor_quantity,
    &sensor_unit,
    &sensor_gain,
    &actuator_gain,
    &overall_gain,
    &sensor_position,
    &actuator_position,
    &sensor_direction,
    &actuator_direction,
    &delay,
    &sensor_delay,
    &actuator_delay,
    &low_pass,
    &sensor_low_pass,
    &actuator_low_pass,
    &youngs_modulus,
    &density,
    &thickness,
    &orthotropy,
    &modulus_field,
    &thickness_field,
    &local_stiffness,
    &point_mass,
    &mass_with_inertia,
    &ground_spring,
    &ground_damper,
    &resonator,
    &frame,
    &modal_damping,
    &hysteretic_damping,
};

}  // namespace

std::span<const Effect* const> effects() { return kAll; }

const Effect& effect(std::string_view name) {
  std::string known;
  for (const auto* one : kAll) {
    if (one->name == name) return *one;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", one->name);
  }
  throw InvalidInput(fmt::format("no effect '{}'; there are {}", name, known));
}

double Parameter::value(double x) const {
  if (scale == Scale::logarithmic) return std::exp(x);
  if (scale == Scale::relative) return std::expm1(x);
  return x;
}

double Parameter::coordinate(double of) const {
  if (scale == Scale::logarithmic) return std::log(of);
  if (scale == Scale::relative) return std::log1p(of);
  return of;
}

double Parameter::value_per_coordinate(double x) const {
  if (scale == Scale::logarithmic || scale == Scale::relative) return std::exp(x);
  return 1.0;
}

double log_prior(const Supposed& supposed, const Structure& structure) {
  const auto parameters = supposed.effect->parameters(structure);
  double sum = -std::log(
      static_cast<double>(std::max<Eigen::Index>(1, supposed.effect->options(structure))));
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  bool placed = false;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& parameter = parameters[i];
    const double x = supposed.x(static_cast<Eigen::Index>(i));
    if (parameter.is_place()) {
      place(parameter.scale == Parameter::Scale::place_u ? 0 : 1) = x;
      placed = true;
      continue;
    }
    const double off = (x - parameter.centre) / parameter.width;
    sum -= 0.5 * off * off + std::log(parameter.width * std::sqrt(2.0 * std::numbers::pi));
  }
  if (!placed) return sum;
  if (!structure.surface.at(place)) return -std::numeric_limits<double>::infinity();
  return sum - std::log(structure.surface.area.sum());
}

void keep_on_surface(const Structure& structure, const Supposed& from, Supposed& to) {
  Eigen::Index u = -1;
  Eigen::Index v = -1;
  Eigen::Index i = 0;
  for (const auto& parameter : to.effect->parameters(structure)) {
    if (parameter.scale == Parameter::Scale::place_u) u = i;
    if (parameter.scale == Parameter::Scale::place_v) v = i;
    ++i;
  }
  if (u < 0 || v < 0) return;
  for (int half = 0; half < 12 && !structure.surface.at({to.x(u), to.x(v)}); ++half) {
    to.x(u) = 0.5 * (to.x(u) + from.x(u));
    to.x(v) = 0.5 * (to.x(v) + from.x(v));
  }
}

Eigen::Index one_option(const Structure& /*structure*/) { return 1; }
std::vector<std::string> no_channels(const Structure& /*structure*/, Eigen::Index /*option*/) {
  return {};
}

}  // namespace chladni::diagnosis
