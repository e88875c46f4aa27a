// The scale between sensors and actuators of an identified model: what the study and its simulation
// say of it.
#pragma once

#include "app/steps/identification.h"

namespace chladni::app {

[[nodiscard]] inline IdentificationPlan identification_plan(const Study& study) {
  return study.identification.value_or(IdentificationPlan{});
}

/// Fills model.pairs and matches the gains. Modes that no pair tells are told by the simulation,
/// with the errors and corrections of it that the shapes of the side with more channels teach.
/// @param solution  of the study; null: solved only where pairs lie apart, and what no pair tells
///                  stays without a scale
/// @throws as its steps
[[nodiscard]] identification::GainMatch matched(const Study& study, const Solution* solution,
                                                IdentifiedModel& model, Run& run);

}  // namespace chladni::app
