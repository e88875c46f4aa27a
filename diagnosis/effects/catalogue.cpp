#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "diagnosis/effects/entries.h"

namespace chladni::diagnosis {
namespace {

constexpr std::array kAll{
#define EFFECT(name, file) &name,
#include "diagnosis/effects/entries.inc"
#undef EFFECT
};

// Indices of the coordinates u and v.
std::optional<std::array<Eigen::Index, 2>> place_coordinates(const Supposed& supposed,
                                                             const Structure& structure) {
  std::array<Eigen::Index, 2> at{-1, -1};
  Eigen::Index i = 0;
  for (const auto& parameter : supposed.effect->parameters(structure)) {
    if (parameter.role == Parameter::Role::place_u) at[0] = i;
    if (parameter.role == Parameter::Role::place_v) at[1] = i;
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
  if (scale == Scale::logarithmic || scale == Scale::factor) return std::exp(x);
  if (scale == Scale::relative) return std::expm1(x);
  return x;
}

namespace {

// The value of the first parameter for which `is` holds.
template <typename Is>
std::optional<double> value_of(const Supposed& supposed, const Structure& structure, Is is) {
  const auto parameters = supposed.effect->parameters(structure);
  const auto found = std::ranges::find_if(parameters, is);
  if (found == parameters.end()) return std::nullopt;
  return found->value(supposed.x(found - parameters.begin()));
}

}  // namespace

double Parameter::coordinate(double of) const {
  if (scale == Scale::logarithmic || scale == Scale::factor) return std::log(of);
  if (scale == Scale::relative) return std::log1p(of);
  return of;
}

Parameter::Ends Parameter::ends() const {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (is_place()) return {-kInfinite, kInfinite};
  const double far = kPlausible * width;
  return {centre - far, std::min(centre + far, most)};
}

double Parameter::value_per_coordinate(double x) const {
  return scale == Scale::linear ? 1.0 : std::exp(x);
}

namespace {

// The value of the cause's parameter for the other effect; its centre if there is none.
double shared_coordinate(const Parameter& wanted, const Supposed& cause,
                         const std::vector<Parameter>& parameters) {
  const auto same = std::ranges::find(parameters, wanted.name, &Parameter::name);
  if (same != parameters.end()) {
    return wanted.coordinate(same->value(cause.x(same - parameters.begin())));
  }
  if (cause.effect->implied == nullptr) return wanted.centre;
  const auto implied = cause.effect->implied(wanted.name, cause.x);
  return implied ? wanted.coordinate(*implied) : wanted.centre;
}

}  // namespace

Supposed counterpart(const Supposed& cause, const Effect& effect, const Structure& structure) {
  const auto known = cause.effect->parameters(structure);
  const auto parameters = effect.parameters(structure);
  Supposed other{&effect, cause.option,
                 Eigen::VectorXd(static_cast<Eigen::Index>(parameters.size()))};
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    other.x(static_cast<Eigen::Index>(i)) = shared_coordinate(parameters[i], cause, known);
  }
  return other;
}

std::vector<Supposed> simplified(const Supposed& supposed, const Structure& structure) {
  std::vector<Supposed> all;
  for (const auto& [simpler, share] : supposed.effect->simpler) {
    if (supposed.option >= simpler->options(structure)) continue;
    all.push_back(counterpart(supposed, *simpler, structure));
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

bool near(const Structure& structure, const Supposed& a, const Supposed& b, double part) {
  const auto here = place_of(a, structure);
  const auto there = place_of(b, structure);
  return !here || !there || (*here - *there).norm() < part * structure.surface.size();
}

bool same_choice(const Structure& structure, const Supposed& a, const Supposed& b, double part) {
  return a.effect == b.effect && a.option == b.option && near(structure, a, b, part);
}

double reach_of(const Supposed& supposed, const Structure& structure) {
  const auto is_extent = [](const Parameter& one) { return one.role == Parameter::Role::extent; };
  return value_of(supposed, structure, is_extent).value_or(0.0);
}

double error_of(const Supposed& supposed, const Structure& structure) {
  const auto& effect = *supposed.effect;
  if (!effect.error_follows_size) return effect.error;
  const auto is_size = [](const Parameter& one) { return one.is_size; };
  return effect.error *
         std::min(1.0, std::abs(value_of(supposed, structure, is_size).value_or(1.0)));
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
    const auto [low, high] = parameter.ends();
    if (!(low <= x && x <= high)) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * off * off + std::log(parameter.width * std::sqrt(2.0 * std::numbers::pi));
  }
  const auto place = place_of(supposed, structure);
  if (!place) return sum;
  if (!structure.surface.holds(*place)) return -std::numeric_limits<double>::infinity();
  return sum - std::log(structure.surface.area.sum());
}

void keep_on_surface(const Structure& structure, const Supposed& from, Supposed& to) {
  const auto at = place_coordinates(to, structure);
  if (!at) return;
  for (int half = 0; half < 12 && !structure.surface.holds(to.x(*at)); ++half) {
    to.x(*at) = 0.5 * (to.x(*at) + from.x(*at)).eval();
  }
  if (!structure.surface.holds(to.x(*at))) to.x(*at) = from.x(*at);
}

Eigen::Index one_option(const Structure& /*structure*/) { return 1; }
std::vector<std::string> no_channels(const Structure& /*structure*/, Eigen::Index /*option*/) {
  return {};
}

}  // namespace chladni::diagnosis
