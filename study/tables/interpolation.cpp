// [measurement] and [interpolation] of a study: the measured data and what is computed from them.
#include "base/error.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {

std::string source_text(const MeasurementPlan& plan) {
  return plan.source.empty() ? "" : "; it does not come with the study: " + plan.source;
}

std::filesystem::path read_path(TableReader& table, const StudyFolder& folder, std::string_view key,
                                Study& study, const std::string& hint) {
  const auto text = table.text(key);
  if (!text) return {};
  try {
    const auto path = folder.resolved(*text);
    const TomlNode& node = *table.find(key);
    study.files.push_back({table.name(key), path, node.line, node.column});
    return path;
  } catch (const InvalidInput& e) {
    table.wrong(*table.find(key), table.name(key) + ": " + e.what() + hint);
    return {};
  }
}

namespace {

// A number of modes of the truth, or a file of measured modes.
void read_modes(TableReader& table, const StudyFolder& folder, MeasurementPlan& plan,
                Study& study) {
  const TomlNode* node = table.find("modes");
  if (node == nullptr) return;
  if (node->kind != TomlNode::Kind::text) {
    plan.modes = static_cast<int>(table.integer("modes", 1, kMostModes).value_or(0));
    return;
  }
  plan.modes_file = read_path(table, folder, "modes", study, source_text(plan));
  for (const char* other : {"frf", "time"}) {
    if (!table.has(other)) continue;
    table.wrong(*node, "measurement has modes in a file and " + std::string(other) +
                           "; expected one of them: the modes of responses are identified");
  }
}

// Modes measured before those of `modes`; "": none, where the study that this one extends has some.
void read_reference(TableReader& table, const StudyFolder& folder, MeasurementPlan& plan,
                    Study& study) {
  const TomlNode* node = table.find("reference");
  if (node == nullptr || (node->kind == TomlNode::Kind::text && node->text.empty())) return;
  plan.reference = read_path(table, folder, "reference", study, source_text(plan));
  if (plan.modes_file.empty()) {
    table.wrong(*node,
                "measurement has a reference without modes; expected the modes measured later, "
                "modes = \"after.csv\"");
  }
}

void require_data(TableReader& table) {
  const TomlNode* modes = table.find("modes");
  const bool has_modes = modes != nullptr && modes->kind == TomlNode::Kind::text;
  if (has_modes || table.has("frf") || table.has("time") || table.has("shapes") ||
      table.has("truth")) {
    return;
  }
  table.missing("frf",
                "frf = \"measured.uff\", time = \"recorded.csv\", shapes = \"shapes.csv\", modes "
                "= \"modes.csv\" or truth = \"real.toml\" (a study whose modes stand for measured "
                "ones)");
}

// Keys of recordings that change nothing beside the others.
void refuse_idle_recording_keys(TableReader& table, const MeasurementPlan& plan) {
  for (const auto* key : {"period", "sample_rate", "inputs", "transient", "force_window",
                          "exponential_window", "hammer"}) {
    if (!table.has(key) || !plan.time.empty()) continue;
    table.wrong(
        *table.find(key),
        table.name(key) + " changes nothing here; expected time = \"recorded.csv\" beside it");
  }
  if (table.has("validation") && plan.frf.empty() && plan.time.empty()) {
    table.wrong(*table.find("validation"),
                table.name("validation") +
                    " changes nothing here; expected frf = \"measured.uff\" or time = "
                    "\"recorded.csv\" beside it, of which a fit predicts it");
  }
  if (plan.recording.exponential_window > 0.0 && table.has("hold_out")) {
    table.wrong(*table.find("hold_out"), table.name("hold_out") +
                                             " cannot be scored beside an exponential_window: the "
                                             "window is in its responses; expected longer records");
  }
}

}  // namespace

void read_measurement(TableReader& root, const StudyFolder& folder, Study& study) {
  auto table = root.table("measurement");
  if (!table) return;
  auto& plan = study.measurement.emplace();
  measurement_schema().read(*table, plan);
  plan.frf = read_path(*table, folder, "frf", study, source_text(plan));
  plan.time = read_path(*table, folder, "time", study, source_text(plan));
  plan.validation = read_path(*table, folder, "validation", study, source_text(plan));
  plan.shapes = read_path(*table, folder, "shapes", study, source_text(plan));
  plan.truth = read_path(*table, folder, "truth", study);
  read_modes(*table, folder, plan, study);
  read_reference(*table, folder, plan, study);
  require_data(*table);
  if (table->has("shapes") && table->has("truth")) {
    table->wrong(*table->find("truth"), "measurement has shapes and truth; expected one of them");
  }
  plan.hold_out = table->texts("hold_out");
  refuse_idle_recording_keys(*table, plan);
  refuse_strangers(*table, "hold_out", "channel of the study", plan.hold_out, channel_names(study));
  table->refuse_unknown();
}

void read_interpolation(TableReader& root, Study& study) {
  auto table = root.table("interpolation");
  if (!table) return;
  interpolation_schema().read(*table, study.interpolation.emplace());
  table->refuse_unknown();
}

}  // namespace chladni::study
