#include "hidden_effects/shipped_structure.h"

#include <fstream>

#include "app/quiet_run.h"
#include "stage/diagnosis_structure.h"

namespace chladni::hidden_effects {

Shipped shipped(const simulators::Rig& rig, double edge_length) {
  const app::TestFolder folder("shipped_" + rig.name);
  if (!rig.surface.empty()) std::ofstream(folder.path() / "body.off") << rig.surface;
  const auto study = stage::with_modes_for_diagnosis(
      study::parse_study(simulators::study_text(rig, edge_length), folder.path() / "study.toml"));
  app::QuietRun quiet(study, folder.path());
  const auto solution = stage::solved(study, quiet.run());
  Shipped made{stage::structure_of(study, solution, rig.high_hz), {}};
  made.options.tolerances = study.diagnosis.value_or(study::DiagnosisPlan{}).tolerances;
  return made;
}

}  // namespace chladni::hidden_effects
