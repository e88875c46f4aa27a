#include "diagnosis/modes/calibration/constants_held.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "base/error.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = CalibratedConstant::Kind;

std::vector<Parameter> logarithm(const Structure& /*structure*/) {
  return {{.name = "relative",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .width = 0.2,
           .step = 1e-5}};
}

Index has_directions(const Structure& structure) {
  return structure.directional.along_u.size() > 0 ? 1 : 0;
}

// The study states damping ratios, so they stay where a constant changes the frequencies: each
// mode's damping grows by `by`. Dashpots keep theirs.
void scale_damping_of_modes(State& state, const VectorXd& by) {
  const VectorXd root = by.cwiseSqrt();
  MatrixXd own = state.damping;
  if (state.dashpots.size() > 0) own -= state.dashpots;
  state.damping += root.asDiagonal() * own * root.asDiagonal() - own;
  note_kept_ratios(state, by);
}

void scale_damping_of_all(State& state, double by) {
  scale_damping(state, by);
  note_kept_ratios(state, VectorXd::Constant(state.mode_count(), by));
}

void stretch(State& state, const MatrixXd& part, double x) {
  const MatrixXd change = std::expm1(x) * part;
  const VectorXd before = state.stiffness.diagonal();
  state.stiffness += change;
  VectorXd by = VectorXd::Ones(before.size());
  for (Index k = 0; k < by.size(); ++k) {
    const double ratio = 1.0 + change(k, k) / before(k);
    if (before(k) > kConstants.no_stiffness * before.maxCoeff() && ratio > 0.0) {
      by(k) = std::sqrt(ratio);
    }
  }
  scale_damping_of_modes(state, by);
}

void stretch_u(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  stretch(state, structure.directional.along_u, x(0));
}
// ν of the first axis stays: the stiffness between both follows that of the second one.
void stretch_v(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  stretch(state, structure.directional.along_v + structure.directional.across, x(0));
}
void shear(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  stretch(state, structure.directional.shear, x(0));
}
void stiffen(State& state, const Structure& /*structure*/, Index /*option*/, const VectorXd& x) {
  scale_stiffness(state, std::exp(x(0)));
  scale_damping_of_all(state, std::exp(0.5 * x(0)));
}
void weigh(State& state, const Structure& /*structure*/, Index /*option*/, const VectorXd& x) {
  scale_mass(state, std::exp(x(0)));
  scale_damping_of_all(state, std::exp(0.5 * x(0)));
}
// Frequencies and mass go as the thickness.
void thicken(State& state, const Structure& structure, Index option, const VectorXd& x) {
  static const Effect& own = effect("thickness");
  own.apply(state, structure, option, x);
  scale_damping_of_all(state, std::exp(2.0 * x(0)));
}

Index has_bending(const Structure& structure) { return structure.bending_power > 0.0 ? 1 : 0; }

struct Way {
  std::string_view name;
  void (*apply)(State&, const Structure&, Index, const VectorXd&);
  Index (*options)(const Structure&);
  double Tolerances::*tolerance;
  bool is_scale;
};
constexpr std::size_t kDirections = 3;  // come first
constexpr std::array<Way, 6> kWays{{
    {"stiffness_along_u", stretch_u, has_directions, &Tolerances::orthotropy, false},
    {"stiffness_along_v", stretch_v, has_directions, &Tolerances::orthotropy, false},
    {"shear_stiffness", shear, has_directions, &Tolerances::orthotropy, false},
    {"youngs_modulus", stiffen, one_option, &Tolerances::modulus, true},
    {"density", weigh, one_option, &Tolerances::density, true},
    {"thickness", thicken, has_bending, &Tolerances::thickness, true},
}};

std::vector<Effect> made_effects() {
  std::vector<Effect> all;
  for (const auto& way : kWays) {
    Effect effect{};
    effect.name = way.name;
    effect.summary = "a constant of the study, its damping ratios kept";
    effect.source = "K, M or a part of K by elastic constant, times a factor";
    effect.parameters = logarithm;
    effect.options = way.options;
    effect.channels = no_channels;
    effect.apply = way.apply;
    effect.tolerance = way.tolerance;
    effect.is_scale = way.is_scale;
    all.push_back(effect);
  }
  return all;
}

double width_of(const CalibratedConstant& constant, const Effect& effect,
                const Tolerances& tolerances) {
  if (constant.kind == Kind::unknown) return kConstants.unknown_constant;
  require(constant.deviation >= 0.0 && std::isfinite(constant.deviation),
          constant.name + ": its deviation must not be negative");
  const double least = effect.tolerance == nullptr ? 0.0 : tolerances.*effect.tolerance;
  const double width =
      constant.kind == Kind::known ? std::max(constant.deviation, least) : constant.deviation;
  require(width > 0.0, constant.name + ": its deviation must be above 0");
  return width;
}

bool holds(const std::vector<HeldConstant>& constants, std::string_view effect) {
  return std::ranges::any_of(constants,
                             [&](const HeldConstant& one) { return one.effect->name == effect; });
}

bool holds_all_directions(const std::vector<HeldConstant>& constants) {
  return std::all_of(kWays.begin(), kWays.begin() + kDirections,
                     [&](const Way& one) { return holds(constants, one.name); });
}

}  // namespace

const Effect& held_effect(const std::string& constant, std::string_view name) {
  static const std::vector<Effect> all = made_effects();
  for (const auto& one : all) {
    if (one.name == name) return one;
  }
  require(name == "modal_damping",
          fmt::format("{} is calibrated by \"{}\", which is no constant", constant, name));
  return effect(name);
}

std::vector<HeldConstant> held_constants(const Structure& structure,
                                         const std::vector<CalibratedConstant>& constants,
                                         const Tolerances& tolerances,
                                         std::vector<std::string>& notes) {
  std::vector<HeldConstant> all;
  for (const auto& constant : constants) {
    const Effect& effect = held_effect(constant.name, constant.effect);
    require(!holds(all, effect.name), constant.name + " is stated twice");
    if (effect.options(structure) <= 0) {
      notes.push_back(constant.name +
                      " keeps its value: this model of the body does not show what it changes");
      continue;
    }
    all.push_back({constant, &effect, width_of(constant, effect, tolerances)});
  }
  // They are parts of the stiffness that others scale as a whole.
  std::ranges::stable_partition(
      all, [](const HeldConstant& one) { return one.effect->options == has_directions; });
  return all;
}

std::vector<const Effect*> sought_beside(const std::vector<HeldConstant>& constants,
                                         std::vector<const Effect*> catalogue,
                                         const Structure& structure) {
  const auto does_as_widely = [&](const HeldConstant& one, const Effect& effect) {
    if (one.stated.kind == Kind::measured || one.effect->name != effect.name) {
      return false;
    }
    return one.width >= 0.5 * effect.parameters(structure).front().width;
  };
  const bool all_directions = holds_all_directions(constants);
  std::erase_if(catalogue, [&](const Effect* effect) {
    const bool is_of_directions = effect->name == "orthotropy" || effect->name == "youngs_modulus";
    return (all_directions && is_of_directions) ||
           std::ranges::any_of(
               constants, [&](const HeldConstant& one) { return does_as_widely(one, *effect); });
  });
  return catalogue;
}

LeftTolerances tolerances_left(const std::vector<HeldConstant>& constants,
                               const Tolerances& tolerances) {
  LeftTolerances left{tolerances, !holds(constants, "thickness")};
  const bool all_directions = holds_all_directions(constants);
  if (holds(constants, "youngs_modulus") || all_directions) left.tolerances.modulus = 0.0;
  if (holds(constants, "density")) left.tolerances.density = 0.0;
  if (all_directions) left.tolerances.orthotropy = 0.0;
  return left;
}

double log_prior(const std::vector<HeldConstant>& constants, const VectorXd& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const double off = x(static_cast<Index>(i)) / constants[i].width;
    if (!(std::abs(off) < kPlausible)) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * off * off + std::log(constants[i].width * std::sqrt(2.0 * std::numbers::pi));
  }
  return sum;
}

}  // namespace chladni::diagnosis
