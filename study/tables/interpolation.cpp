// [measurement] and [interpolation] of a study: the measured data and what is computed from them.
#include "base/error.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {

std::string source_text(const MeasurementPlan& plan) {
  return plan.source.empty() ? "" : "; it does not come with the study: " + plan.source;
}

std::filesystem::path read_path(TableReader& table, const StudyFolder& folder, std::string_view key,
                                const std::string& hint) {
  const auto text = table.text(key);
  if (!text) return {};
  try {
    return folder.resolved(*text);
  } catch (const InvalidInput& e) {
    table.wrong(*table.find(key), table.name(key) + ": " + e.what() + hint);
    return {};
  }
}

void read_measurement(TableReader& root, const StudyFolder& folder, Study& study) {
  auto table = root.table("measurement");
  if (!table) return;
  auto& plan = study.measurement.emplace();
  measurement_schema().read(*table, plan);
  plan.frf = read_path(*table, folder, "frf", source_text(plan));
  plan.time = read_path(*table, folder, "time", source_text(plan));
  plan.shapes = read_path(*table, folder, "shapes", source_text(plan));
  plan.truth = read_path(*table, folder, "truth");
  for (const auto& [key, path] :
       {std::pair("frf", plan.frf), std::pair("time", plan.time), std::pair("shapes", plan.shapes),
        std::pair("truth", plan.truth)}) {
    if (path.empty()) continue;
    const TomlNode& node = *table->find(key);
    study.files.push_back({table->name(key), path, node.line, node.column});
  }
  if (!table->has("frf") && !table->has("time") && !table->has("shapes") && !table->has("truth")) {
    table->missing("frf",
                   "frf = \"measured.uff\", time = \"recorded.csv\", shapes = \"shapes.csv\" or "
                   "truth = \"real.toml\" (a study whose modes stand for measured ones)");
  }
  if (table->has("shapes") && table->has("truth")) {
    table->wrong(*table->find("truth"), "measurement has shapes and truth; expected one of them");
  }
  plan.modes = static_cast<int>(table->integer("modes", 1, kMostModes).value_or(0));
  plan.hold_out = table->texts("hold_out");
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
