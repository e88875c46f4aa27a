#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

// Causes in a channel come before causes in the body, because they cost less to check.
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
    &sensor_crosstalk,
    &actuator_crosstalk,
    &delay,
    &sensor_delay,
    &actuator_delay,
    &low_pass,
    &sensor_low_pass,
    &actuator_low_pass,
    &youngs_modulus,
    &density,
    &thickness,
    &size_error,
    &orthotropy,
    &modulus_field,
    &thickness_field,
    &local_stiffness,
    &point_mass,
    &mass_with_inertia,
    &sensor_masses,
    &actuator_masses,
    &ground_spring,
    &ground_damper,
    &resonator,
    &frame,
    &suspension,
    &modal_damping,
    &hysteretic_damping,
    &modes_above,
    &drift,
};

// Indices of the coordinates u and v.
std::optional<std::array<Eigen::Index, 2>> place_coordinates(const Supposed& supposed,
                                                             const Structure& structure) {
  std::array<Eigen::Index, 2> at{-1, -1};
  Eigen::Index i = 0;
  for (const auto& parameter : supposed.effect->parameters(structure)) {
    if (parameter.scale == Parameter::Scale::place_u) at[0] = i;
    if (parameter.scale == Parameter::Scale::place_v) at[1] = i;
    ++i;
  }
  if (at[0] < 0 || at[1] < 0) return std::nullopt;
  return at;
}

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

Choice choice_of(const Effect& effect, Eigen::Index option) {
  return effect.choice == nullptr ? Choice{} : effect.choice(option);
}

double Parameter::value(double x) const {
  if (scale == Scale::logarithmic) return std::exp(x);
  if (scale == Scale::relative) return std::expm1(x);
  return x;
}

namespace {

std::optional<double> value_of(const Supposed& supposed, const Structure& structure,
                               std::string_view name) {
  const auto parameters = supposed.effect->parameters(structure);
  const auto found = std::ranges::find(parameters, name, &Parameter::name);
  if (found == parameters.end()) return std::nullopt;
  return found->value(supposed.x(found - parameters.begin()));
}

}  // namespace

double Parameter::coordinate(double of) const {
  if (scale == Scale::logarithmic) return std::log(of);
  if (scale == Scale::relative) return std::log1p(of);
  return of;
}

double Parameter::value_per_coordinate(double x) const {
  if (scale == Scale::logarithmic || scale == Scale::relative) return std::exp(x);
  return 1.0;
}

namespace {

struct SimplerPair {
  std::string_view general, simpler;
  double share = 0.0;
};

// The pole of a resonator is not visible if it brings less than this part of the gain: it lies
// outside the band or is heavily damped.
constexpr double kPoleUnseen = 0.01;

// Rotary inertia depends on the slopes of the shapes, in which solvers differ more than in the
// shapes. A point mass from another solver was found with a radius of gyration of 12 mm, for 0.0006
// of its gain. Radii of 25 mm and more bring a tenth of the gain and more.
constexpr double kTurnsOtherwise = 0.002;

constexpr std::array kSimpler{
    SimplerPair{"mass_with_inertia", "point_mass", kTurnsOtherwise},
    SimplerPair{"resonator", "point_mass", kPoleUnseen},
    SimplerPair{"resonator", "ground_spring", kPoleUnseen},
    SimplerPair{"resonator", "ground_damper", kPoleUnseen},
    SimplerPair{"modulus_field", "youngs_modulus"},
    SimplerPair{"thickness_field", "thickness"},
    SimplerPair{"hysteretic_damping", "modal_damping"},
    SimplerPair{"sensor_gain", "sensor_sign"},
    SimplerPair{"actuator_gain", "actuator_sign"},
    SimplerPair{"sensor_direction", "sensor_position"},
    SimplerPair{"actuator_direction", "actuator_position"},
};

// The value of the general effect's parameter for the simpler effect; its centre if there is none.
double shared_coordinate(const Parameter& wanted, const Supposed& general,
                         const std::vector<Parameter>& parameters) {
  const auto same = std::ranges::find(parameters, wanted.name, &Parameter::name);
  if (same != parameters.end()) {
    return wanted.coordinate(same->value(general.x(same - parameters.begin())));
  }
  if (general.effect->implied == nullptr) return wanted.centre;
  const auto implied = general.effect->implied(wanted.name, general.x);
  return implied ? wanted.coordinate(*implied) : wanted.centre;
}

}  // namespace

std::vector<Simpler> simpler_of(const Effect& effect) {
  std::vector<Simpler> all;
  for (const auto& pair : kSimpler) {
    if (pair.general == effect.name) all.push_back({&diagnosis::effect(pair.simpler), pair.share});
  }
  return all;
}

std::vector<Supposed> simplified(const Supposed& supposed, const Structure& structure) {
  const auto general = supposed.effect->parameters(structure);
  std::vector<Supposed> all;
  for (const auto& [simpler, share] : simpler_of(*supposed.effect)) {
    if (supposed.option >= simpler->options(structure)) continue;
    const auto parameters = simpler->parameters(structure);
    Supposed one{simpler, supposed.option,
                 Eigen::VectorXd(static_cast<Eigen::Index>(parameters.size()))};
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      one.x(static_cast<Eigen::Index>(i)) = shared_coordinate(parameters[i], supposed, general);
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::function<void(State&)> change_of(const Supposed& supposed, const Structure& structure) {
  const Effect& effect = *supposed.effect;
  if (effect.change) return effect.change(structure, supposed.option, supposed.x);
  return [&supposed, &structure](State& state) {
    supposed.effect->apply(state, structure, supposed.option, supposed.x);
  };
}

std::optional<Eigen::Vector2d> place_of(const Supposed& supposed, const Structure& structure) {
  const auto at = place_coordinates(supposed, structure);
  if (!at) return std::nullopt;
  return Eigen::Vector2d(supposed.x(*at));
}

double reach_of(const Supposed& supposed, const Structure& structure) {
  return value_of(supposed, structure, "radius").value_or(0.0);
}

double error_of(const Supposed& supposed, const Structure& structure) {
  const double factor = value_of(supposed, structure, "factor").value_or(1.0);
  return supposed.effect->error * std::min(1.0, std::abs(factor));
}

double log_prior(const Supposed& supposed, const Structure& structure) {
  const auto parameters = supposed.effect->parameters(structure);
  double sum = -std::log(
      static_cast<double>(std::max<Eigen::Index>(1, supposed.effect->options(structure))));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& parameter = parameters[i];
    if (parameter.is_place()) continue;
    const double x = supposed.x(static_cast<Eigen::Index>(i));
    const double off = (x - parameter.centre) / parameter.width;
    if (!(std::abs(off) < kPlausible)) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * off * off + std::log(parameter.width * std::sqrt(2.0 * std::numbers::pi));
  }
  const auto place = place_of(supposed, structure);
  if (!place) return sum;
  if (!structure.surface.at(*place)) return -std::numeric_limits<double>::infinity();
  return sum - std::log(structure.surface.area.sum());
}

void keep_on_surface(const Structure& structure, const Supposed& from, Supposed& to) {
  const auto at = place_coordinates(to, structure);
  if (!at) return;
  for (int half = 0; half < 12 && !structure.surface.at(to.x(*at)); ++half) {
    to.x(*at) = 0.5 * (to.x(*at) + from.x(*at)).eval();
  }
  if (!structure.surface.at(to.x(*at))) to.x(*at) = from.x(*at);
}

Eigen::Index one_option(const Structure& /*structure*/) { return 1; }
std::vector<std::string> no_channels(const Structure& /*structure*/, Eigen::Index /*option*/) {
  return {};
}

}  // namespace chladni::diagnosis
