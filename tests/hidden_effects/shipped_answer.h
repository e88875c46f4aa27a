// What `chladni diagnose` says of a rig, from a study with a file of its responses.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "modal/frf_set.h"
#include "simulators/rigs/real_rig.h"
#include "simulators/tables/rig.h"
#include "steps/diagnosis.h"

namespace chladni::hidden_effects {

struct ShippedAnswer {
  diagnosis::Diagnosis result;
  steps::Gain gain;
  double seconds = 0.0;                               ///< without the solution of the study
  std::vector<std::pair<std::string, double>> steps;  ///< and their seconds
};

/// The rig's responses go into a file beside the study that somebody writes who knows nothing else
/// of it, and all steps of the verb run. Cost: the first time of a body also its mesh and modes.
/// @param edge_length  of the mesh [m]; 0: left to the program
/// @throws as steps::diagnosed
[[nodiscard]] ShippedAnswer shipped_answer(const simulators::Rig& rig,
                                           const modal::FrfSet& measured, double edge_length = 0.0);
[[nodiscard]] inline ShippedAnswer shipped_answer(const simulators::RealRigCase& rig,
                                                  double edge_length = 0.0) {
  return shipped_answer(rig.body.rig, rig.measured, edge_length);
}

}  // namespace chladni::hidden_effects
