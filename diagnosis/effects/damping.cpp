#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> level(const Structure& /*structure*/) {
  return {{.name = "factor",
           .unit = "1",
           .scale = Parameter::Scale::factor,
           .is_size = true,
           .width = 0.8,
           .step = 1e-4}};
}

void scale(State& state, const Structure& /*structure*/, Eigen::Index /*option*/,
           const VectorXd& x) {
  scale_damping(state, std::exp(x(0)));
}

std::vector<EffectStart> levels(const Scene& /*scene*/) {
  std::vector<EffectStart> starts;
  for (double factor = 0.1; factor < 11.0; factor *= 1.25) {
    starts.push_back({0, VectorXd::Constant(1, std::log(factor))});
  }
  return starts;
}

std::vector<Parameter> hysteresis(const Structure& /*structure*/) {
  return {
      {.name = "share", .unit = "1", .is_size = true, .centre = 0.5, .width = 0.5, .step = 1e-4},
      {.name = "factor",
       .unit = "1",
       .scale = Parameter::Scale::factor,
       .width = 0.3,
       .step = 1e-4}};
}

// Makes a part of each mode's losses proportional to displacement instead of velocity: 2ζω², not
// 2ζωs. Attachments keep their dashpots.
void relax(State& state, const Structure& structure, Eigen::Index /*option*/, const VectorXd& x) {
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * structure.frequency_hz;
  const Eigen::VectorXd root = omega.cwiseSqrt();
  const double factor = std::exp(x(1));
  Eigen::MatrixXd own = state.damping;
  if (state.dashpots.size() > 0) own -= state.dashpots;
  scale_damping(state, (1.0 - x(0)) * factor);
  state.loss += x(0) * factor * (root.asDiagonal() * own * root.asDiagonal());
}

std::vector<EffectStart> shares(const Scene& /*scene*/) {
  return {{0, Eigen::Vector2d(0.5, 0.0)}, {0, Eigen::Vector2d(1.0, 0.0)}};
}

}  // namespace

constinit const Effect modal_damping{
    .name = "modal_damping",
    .summary = "all modes are damped more or less than supposed",
    .source = "D times a factor",
    .confusable = "gains (peak against flank decides), a damper in one place",
    .parameters = level,
    .options = one_option,
    .channels = no_channels,
    .apply = scale,
    .starts = levels,
    .tolerance = &Tolerances::damping,
    .in_study = {.table = InStudy::Table::modes,
                 .keys = {{"damping_ratio", "factor", "", StudyKey::How::times}}},
};
constinit const Effect hysteretic_damping{
    .name = "hysteretic_damping",
    .summary = "losses follow the displacement, not the speed",
    .source = "K (1 + j eta) instead of s D",
    .confusable = "modal damping that differs from mode to mode",
    .parameters = hysteresis,
    .options = one_option,
    .channels = no_channels,
    .apply = relax,
    .starts = shares,
    .simpler = {{&modal_damping}},
};

}  // namespace chladni::diagnosis
