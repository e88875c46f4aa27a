// A rig as the program that ships sees it: study, tetrahedra, structure_of. Nothing of it comes
// from the code that makes the truth.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/structure.h"
#include "simulators/tables/rig.h"

namespace chladni::hidden_effects {

struct Shipped {
  diagnosis::Structure structure;
  diagnosis::DiagnosisOptions options;  ///< of a study that states none
};

/// Cost: meshing and 64 modes, 3 to 10 s.
/// @param edge_length  of the mesh [m]; 0: left to the program
/// @throws as its steps
[[nodiscard]] Shipped shipped(const simulators::Rig& rig, double edge_length = 0.0);

}  // namespace chladni::hidden_effects
