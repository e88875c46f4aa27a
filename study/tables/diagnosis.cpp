// [diagnosis] of a study, and its tolerances.
#include "base/error.h"
#include "host/atomic_file.h"
#include "study/schemas.h"
#include "study/tables/tables.h"

namespace chladni::study {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 20U;

diagnosis::Tolerances tolerances_of(TableReader& table) {
  diagnosis::Tolerances result;
  tolerances_schema().read(table, result);
  table.refuse_unknown();
  return result;
}

// Reads the tolerances from a separate file, or from a table in the study.
void read_tolerances_part(TableReader& table, const StudyFolder& folder, DiagnosisPlan& plan,
                          Study& study) {
  const TomlNode* node = table.find("tolerances");
  if (node == nullptr) return;
  if (node->kind == TomlNode::Kind::table) {
    auto inner = *table.table("tolerances");
    plan.tolerances = tolerances_of(inner);
    return;
  }
  plan.tolerances_file = read_path(table, folder, "tolerances", study);
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
  diagnosis_schema().read(*table, plan);
  read_tolerances_part(*table, folder, plan, study);
  if (auto costs = table->table("costs")) {
    costs_schema().read(*costs, plan.costs);
    costs->refuse_unknown();
  }
  table->refuse_unknown();
}

diagnosis::Tolerances read_tolerances(const std::filesystem::path& file) {
  require(!std::filesystem::is_directory(file),
          file.string() + " is a folder; expected a file such as tolerances.toml");
  const TomlNode tree = parse_toml(read_whole(file, kLargestFile), file.string());
  Problems problems(file.string());
  TableReader root(tree, "", problems, "the file of tolerances");
  const auto result = tolerances_of(root);
  problems.throw_if_any();
  return result;
}

}  // namespace chladni::study
