// Scale between sensors and actuators of an identified model, from the study and its simulation.
#pragma once

#include "steps/identification.h"

namespace chladni::steps {

[[nodiscard]] inline study::IdentificationPlan identification_plan(const study::Study& study) {
  return study.identification.value_or(study::IdentificationPlan{});
}

/// The gains of a fit. For modes without a pair the simulation gives the scale, with the errors and
/// corrections that the shapes of the side with more channels show.
/// @param solution  of the study; null: solved only if the two places of a pair differ; modes
///                  without a pair then have no scale
/// @throws as its steps
[[nodiscard]] identification::ChannelGains gains_of(const study::Study& study,
                                                    const stage::Solution* solution,
                                                    const IdentifiedModel& model,
                                                    stage::Work& work);

}  // namespace chladni::steps
