#include "hidden_effects/shipped_structure.h"

#include "app/quiet_run.h"
#include "stage/diagnosis_structure.h"

namespace chladni::hidden_effects {

Shipped shipped(const simulators::Rig& rig, double edge_length) {
  const app::TestFolder folder("shipped_" + rig.name);
  const auto study = app::with_modes_for_diagnosis(
      app::parse_study(simulators::study_text(rig, edge_length), folder.path() / "study.toml"));
  app::QuietRun quiet(study, folder.path());
  const auto solution = app::solved(study, quiet.run());
  Shipped made{app::structure_of(study, solution, rig.high_hz), {}};
  made.options.tolerances = study.diagnosis.value_or(app::DiagnosisPlan{}).tolerances;
  return made;
}

}  // namespace chladni::hidden_effects
