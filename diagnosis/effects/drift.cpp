#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Parameter> first_to_last(const Structure& /*structure*/) {
  return {{.name = "first_to_last", .unit = "1", .is_size = true, .width = 2e-3, .step = 1e-6}};
}

// Needs more than two experiments: one per actuator, in their order.
Index several(const Structure& structure) { return structure.input_count() > 2 ? 1 : 0; }

void warm(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  const Index q = structure.input_count();
  const VectorXd by = VectorXd::LinSpaced(q, -0.5 * x(0), 0.5 * x(0));
  if (state.stiffening.size() == 0) state.stiffening = VectorXd::Zero(q);
  state.stiffening += by;
}

std::vector<EffectStart> drift_steps(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (double by = 2e-5; by < 6.0 * scene.frequency_step(); by *= 3.0) {
    starts.push_back({0, VectorXd::Constant(1, by)});
    starts.push_back({0, VectorXd::Constant(1, -by)});
  }
  return starts;
}

}  // namespace

constinit const Effect drift{
    .name = "drift",
    .summary = "the body's stiffness drifts from experiment to experiment, as with temperature",
    .source = "each column of the responses from a K of its own, evenly from first to last",
    .confusable = "modal damping (averaged peaks), a modulus that is wrong all the time",
    .parameters = first_to_last,
    .options = several,
    .channels = no_channels,
    .apply = warm,
    .starts = drift_steps,
    .in_study = {.refusal = "it is the experiment's: measure in a shorter time or at one "
                            "temperature, or diagnose the first columns alone"},
};

}  // namespace chladni::diagnosis
