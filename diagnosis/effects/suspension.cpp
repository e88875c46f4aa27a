#include <cmath>
#include <numbers>

#include "diagnosis/effects/attachment.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A suspension that is stiffer than this part of the body's first mode holds no whole: the body
// gives way first.
constexpr double kStiffest = 0.7;

std::vector<Parameter> frequency_and_damping(const Structure& structure) {
  const double typical_hz = 0.1 * first_hz(structure);
  return {{.name = "frequency",
           .unit = "Hz",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::frequency,
           .is_size = true,
           .centre = std::log(typical_hz),
           .width = 1.0,
           .step = 1e-4,
           .most = std::log(kStiffest * 10.0 * typical_hz)},
          {.name = "damping_ratio",
           .unit = "1",
           .scale = Parameter::Scale::logarithmic,
           .role = Parameter::Role::shape,
           .centre = std::log(0.1),
           .width = 1.5,
           .step = 1e-4}};
}

Index is_free(const Structure& structure) { return structure.rigid_count > 0 ? 1 : 0; }

void hold_whole(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  const double omega = 2.0 * std::numbers::pi * std::exp(x(0));
  VectorXd rigid = VectorXd::Zero(structure.mode_count());
  rigid.head(structure.rigid_count).setOnes();
  attach_stiffness(state, (omega * omega * rigid).asDiagonal());
  attach_damping(state, (2.0 * std::exp(x(1)) * omega * rigid).asDiagonal());
}

// Effect::error: the model holds every mass separately, which no real suspension does. On a table
// whose thickness varies by 0.15 %, springs of equal stiffness left 0.0055 of their gain.
constexpr double kUneven = 0.01;

std::vector<EffectStart> holds(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (double hz = 0.05 * scene.low_hz(); hz < 0.5 * scene.high_hz(); hz *= 1.25) {
    for (const double ratio : {0.02, 0.1, 0.5}) {
      starts.push_back({0, Eigen::Vector2d(std::log(hz), std::log(ratio))});
    }
  }
  return starts;
}

}  // namespace

constinit const Effect suspension{
    .name = "suspension",
    .summary =
        "the body is held as a whole: a soft suspension, what is left of a control "
        "loop that was not taken out whole",
    .source = "w^2 + 2 z w s on the rigid-body modes, one w and z for all",
    .confusable = "a spring to ground (one place), a support that moves",
    .parameters = frequency_and_damping,
    .options = is_free,
    .channels = no_channels,
    .apply = hold_whole,
    .starts = holds,
    .error = kUneven,
    .in_study = {.refusal =
                     "no key holds a body as a whole: say the springs where they are, or take "
                     "the control loop out of the records"},
};

}  // namespace chladni::diagnosis
