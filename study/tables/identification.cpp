// [identification] of a study: the fit of a modal model to the measurement.
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

void read_band(TableReader& table, IdentificationPlan& plan) {
  const auto band = table.quantities("band", "Hz", 2, Sign::not_negative);
  if (!band) return;
  plan.low_hz = (*band)(0);
  plan.high_hz = (*band)(1);
  if (!(plan.high_hz > plan.low_hz)) {
    table.wrong(*table.find("band"), table.name("band") +
                                         ": its end is not above its start; "
                                         "expected such as [\"10 Hz\", \"800 Hz\"]");
  }
}

void read_pairs(TableReader& table, const Study& study, IdentificationPlan& plan) {
  for (auto& pair : table.tables("pair")) {
    plan.pairs.emplace_back(pair.required_text("sensor"), pair.required_text("actuator"));
    refuse_strangers(pair, "sensor", "sensor of the study", {plan.pairs.back().first},
                     names_of(study.sensors));
    refuse_strangers(pair, "actuator", "actuator of the study", {plan.pairs.back().second},
                     names_of(study.actuators));
    pair.refuse_unknown();
  }
  plan.pairs_within = table.quantity("pairs_within", "m", Sign::positive).value_or(1e-3);
}

// Refuses a key of one fitting method for the other methods, because it has no effect there.
void refuse_unless(bool allowed, TableReader& table, const char* key, const char* expected) {
  if (allowed || !table.has(key)) return;
  table.wrong(*table.find(key),
              table.name(key) + " changes nothing here; expected " + expected + " beside it");
}

void read_weighting(TableReader& table, IdentificationPlan& plan) {
  // By default the thesis' method weighs by magnitude; the study may state another weighting.
  plan.weighting = table.choice("weighting", {"variance", "inverse_magnitude"})
                       .value_or(plan.method == "thesis" ? "inverse_magnitude" : "variance");
  plan.cut_off_db = table.quantity("cut_off_db", "1", Sign::positive).value_or(plan.cut_off_db);
  plan.clip_db = table.quantity("clip_db", "1", Sign::positive).value_or(plan.clip_db);
  refuse_unless(plan.weighting == "inverse_magnitude", table, "clip_db",
                "weighting = \"inverse_magnitude\"");
  if (plan.clip_db >= plan.cut_off_db) {
    table.wrong(*table.find("clip_db"), table.name("clip_db") +
                                            " is not below cut_off_db: all lines would weigh the "
                                            "same; expected a smaller one");
  }
}

void read_thesis_path(TableReader& table, IdentificationPlan& plan) {
  const auto whole = [&](const char* key, int& value, int least, int most) {
    value = static_cast<int>(table.integer(key, least, most).value_or(value));
    refuse_unless(plan.method == "thesis", table, key, "method = \"thesis\"");
  };
  whole("fraction_degree", plan.fraction_degree, 1, 200);
  whole("sanathanan_koerner", plan.sanathanan_koerner, 1, 10000);
  whole("levenberg_marquardt", plan.levenberg_marquardt, 0, 10000);
  whole("modal_iterations", plan.modal_iterations, 1, 10000);
}

}  // namespace

void read_identification(TableReader& root, Study& study) {
  auto table = root.table("identification");
  if (!table) return;
  auto& plan = study.identification.emplace();
  read_band(*table, plan);
  plan.method = table->choice("method", {"likelihood", "thesis"}).value_or(plan.method);
  plan.damping = table->choice("damping", {"modal", "general"}).value_or(plan.damping);
  if (plan.method == "thesis" && plan.damping == "general") {
    table->wrong(*table->find("damping"),
                 table->name("damping") +
                     " is \"general\"; the thesis' path has real modes, expected "
                     "method = \"likelihood\"");
  }
  read_weighting(*table, plan);
  read_thesis_path(*table, plan);
  plan.model_error = table->quantity("model_error", "1", Sign::not_negative);
  plan.modes = static_cast<int>(table->integer("modes", 1, 1000).value_or(0));
  plan.rigid_body_modes =
      static_cast<int>(table->integer("rigid_body_modes", 0, 6).value_or(plan.rigid_body_modes));
  plan.suspended_modes =
      static_cast<int>(table->integer("suspended_modes", 0, 3).value_or(plan.suspended_modes));
  plan.delay = table->truth("delay").value_or(plan.delay);
  plan.delay_of =
      table->choice("delay_of", {"all", "sensors", "actuators"}).value_or(plan.delay_of);
  plan.residual = table->truth("residual").value_or(plan.residual);
  plan.unit = table->text("unit").value_or("");
  read_pairs(*table, study, plan);
  plan.gain = table->choice("gain", {"tied", "thesis"}).value_or(plan.gain);
  plan.gain_errors =
      table->choice("gain_errors", {"none", "sensors", "actuators"}).value_or(plan.gain_errors);
  plan.stabilisation = static_cast<int>(table->integer("stabilisation", 2, 200).value_or(0));
  table->refuse_unknown();
}

}  // namespace chladni::study
