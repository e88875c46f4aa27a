// [identification] of a study: the fit of a modal model to the measurement.
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

void read_pairs(TableReader& table, const Study& study, IdentificationPlan& plan) {
  for (auto& pair : table.tables("pair")) {
    plan.pairs.emplace_back(pair.required_text("sensor"), pair.required_text("actuator"));
    refuse_strangers(pair, "sensor", "sensor of the study", {plan.pairs.back().first},
                     names_of(study.sensors));
    refuse_strangers(pair, "actuator", "actuator of the study", {plan.pairs.back().second},
                     names_of(study.actuators));
    pair.refuse_unknown();
  }
}

// Refuses a key of one fitting method for the other methods, because it has no effect there.
void refuse_unless(bool allowed, TableReader& table, const char* key, const char* expected) {
  if (allowed || !table.has(key)) return;
  table.wrong(*table.find(key),
              table.name(key) + " changes nothing here; expected " + expected + " beside it");
}

// Keys that change nothing beside the others.
void refuse_idle_keys(TableReader& table, const IdentificationPlan& plan) {
  if (plan.method == "thesis" && plan.damping == "general") {
    table.wrong(*table.find("damping"),
                table.name("damping") +
                    " is \"general\"; the thesis' path has real modes, expected "
                    "method = \"likelihood\"");
  }
  refuse_unless(plan.weighting == "inverse_magnitude", table, "clip_db",
                "weighting = \"inverse_magnitude\"");
  refuse_unless(plan.weighting == "variance", table, "model_error", "weighting = \"variance\"");
  if (plan.clip_db >= plan.cut_off_db) {
    table.wrong(*table.find("clip_db"), table.name("clip_db") +
                                            " is not below cut_off_db: all lines would weigh the "
                                            "same; expected a smaller one");
  }
  for (const auto* key :
       {"fraction_degree", "sanathanan_koerner", "levenberg_marquardt", "modal_iterations"}) {
    refuse_unless(plan.method == "thesis", table, key, "method = \"thesis\"");
  }
}

}  // namespace

void read_identification(TableReader& root, Study& study) {
  auto table = root.table("identification");
  if (!table) return;
  auto& plan = study.identification.emplace();
  identification_schema().read(*table, plan);
  if (plan.method == "thesis" && !table->has("weighting")) plan.weighting = "inverse_magnitude";
  refuse_idle_keys(*table, plan);
  read_pairs(*table, study, plan);
  table->refuse_unknown();
}

void read_state_space(TableReader& root, Study& study) {
  auto table = root.table("state_space");
  if (!table) return;
  state_space_schema().read(*table, study.state_space.emplace());
  table->refuse_unknown();
}

}  // namespace chladni::study
