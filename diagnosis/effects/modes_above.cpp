#include <cmath>

#include "diagnosis/effects/entries.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

std::vector<Parameter> relative_flexibility(const Structure& /*structure*/) {
  return {{.name = "relative",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .step = 1e-4}};
}

Eigen::Index is_known(const Structure& structure) { return structure.residual.isZero(0.0) ? 0 : 1; }

void yield(State& state, const Structure& /*structure*/, Eigen::Index /*option*/,
           const VectorXd& x) {
  scale_residual(state, std::exp(x(0)));
}

std::vector<EffectStart> both_ways(const Scene& /*scene*/) {
  std::vector<EffectStart> starts;
  for (const double factor : {1.05, 1.2, 1.5, 2.5, 5.0, 10.0, 0.95, 0.8, 0.5, 0.1}) {
    starts.push_back({0, VectorXd::Constant(1, std::log(factor))});
  }
  return starts;
}

}  // namespace

constinit const Effect modes_above{
    .name = "modes_above",
    .summary = "the modes above the band yield more or less than they should",
    .source = "their static flexibility (1 + r)",
    .confusable = "a modulus: that moves the modes within the band too",
    .parameters = relative_flexibility,
    .options = is_known,
    .channels = no_channels,
    .apply = yield,
    .starts = both_ways,
    .tolerance = &Tolerances::residual,
    .in_study = {.refusal = "no key holds what modes above the band yield: look for what gives way "
                            "locally, under the sensors and actuators"},
};

}  // namespace chladni::diagnosis
