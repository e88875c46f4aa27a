// [diagnosis] of a study, and its tolerances.
#include "base/atomic_file.h"
#include "base/error.h"
#include "diagnosis/effect.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 20U;

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (const auto* effect : diagnosis::effects()) names.emplace_back(effect->name);
  return names;
}

void read_band(TableReader& table, std::string_view key, double& low_hz, double& high_hz) {
  const auto band = table.quantities(key, "Hz", 2, Sign::not_negative);
  if (!band) return;
  low_hz = (*band)(0);
  high_hz = (*band)(1);
  if (high_hz > low_hz) return;
  table.wrong(*table.find(key), table.name(key) +
                                    ": its end is not above its start; expected such as [\"20 "
                                    "Hz\", \"900 Hz\"]");
}

diagnosis::Tolerances tolerances_of(TableReader& table) {
  diagnosis::Tolerances result;
  tolerances_schema().read(table, result);
  table.refuse_unknown();
  return result;
}

// Reads the tolerances from a separate file, or from a table in the study.
void read_tolerances_part(TableReader& table, const StudyFolder& folder, DiagnosisPlan& plan) {
  const TomlNode* node = table.find("tolerances");
  if (node == nullptr) return;
  if (node->kind == TomlNode::Kind::table) {
    auto inner = *table.table("tolerances");
    plan.tolerances = tolerances_of(inner);
    return;
  }
  plan.tolerances_file = read_path(table, folder, "tolerances");
  if (plan.tolerances_file.empty()) return;
  try {
    plan.tolerances = read_tolerances(plan.tolerances_file);
  } catch (const InvalidInput& e) {
    table.wrong(*node, table.name("tolerances") + ": " + e.what());
  }
}

}  // namespace

void read_diagnosis(TableReader& root, const StudyFolder& folder, Study& study) {
  auto table = root.table("diagnosis");
  if (!table) return;
  auto& plan = study.diagnosis.emplace();
  read_band(*table, "band", plan.low_hz, plan.high_hz);
  read_band(*table, "hold_out_band", plan.hold_out_low_hz, plan.hold_out_high_hz);
  read_tolerances_part(*table, folder, plan);
  plan.on = read_faces(*table, "on");
  plan.effects = table->texts("effects");
  refuse_strangers(*table, "effects", "effect (chladni list effects)", plan.effects,
                   effect_names());
  plan.most_causes = static_cast<int>(table->integer("most_causes", 1, 10).value_or(3));
  plan.least_evidence =
      table->quantity("least_evidence", "1", Sign::positive).value_or(plan.least_evidence);
  plan.rival_within =
      table->quantity("rival_within", "1", Sign::positive).value_or(plan.rival_within);
  plan.lines = static_cast<int>(table->integer("lines", 20, 100000).value_or(plan.lines));
  table->refuse_unknown();
}

diagnosis::Tolerances read_tolerances(const std::filesystem::path& file) {
  require(!std::filesystem::is_directory(file),
          file.string() + " is a folder; expected a file such as tolerances.toml");
  const TomlNode tree = parse_toml(read_whole(file, kLargestFile), file.string());
  Problems problems(file.string());
  TableReader root(tree, "", problems);
  const auto result = tolerances_of(root);
  problems.throw_if_any();
  return result;
}

}  // namespace chladni::study
