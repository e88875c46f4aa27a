// Modes and layouts of a study, and the names of its channels.
#include <algorithm>
#include <regex>
#include <set>

#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
std::vector<std::string> names_of(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const auto& channel : channels) names.push_back(channel.name);
  return names;
}

std::vector<std::string> channel_names(const Study& study) {
  auto names = names_of(study.sensors);
  const auto actuators = names_of(study.actuators);
  names.insert(names.end(), actuators.begin(), actuators.end());
  return names;
}

void refuse_strangers(TableReader& table, std::string_view key, const std::string& what,
                      const std::vector<std::string>& wanted,
                      const std::vector<std::string>& known) {
  const TomlNode* node = table.find(key);
  if (node == nullptr) return;  // the one who needs it has said so
  for (const auto& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    table.wrong(*node, table.name(key) + " names \"" + name + "\", but no " + what +
                           " has that name" +
                           (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }
}

// A study is data: of the programs that start ranks it may name three, with a number of ranks.
// Whatever else a launcher takes could start any program, and is for --engine.
bool is_plain_engine(const std::string& engine) {
  static const std::regex plain(
      "(mpiexec|mpirun|srun)( +(-n|-np|-N|--ntasks|--nodes) +[0-9]{1,7}"
      "| +--(oversubscribe|allow-run-as-root))*");
  return std::regex_match(engine, plain);
}

void refuse_mirrors(TableReader& table, const ModesPlan& plan) {
  const auto& axes = plan.mirrors;
  if (axes.empty()) return;
  const auto* node = table.find("mirrors");
  if (std::set(axes.begin(), axes.end()).size() != axes.size()) {
    table.wrong(*node, "modes.mirrors names an axis twice");
  }
  if (!plan.engine.empty()) {
    table.wrong(*node,
                "modes has mirrors and engine: the ranks take the whole body; expected one "
                "of them");
  }
}

void read_modes_part(TableReader& root, Study& study) {
  auto table = root.table("modes");
  if (!table) return;
  modes_schema().read(*table, study.modes);
  if (table->has("count") && table->has("up_to")) {
    table->wrong(*table->find("up_to"), "modes has count and up_to; expected one of them");
  }
  if (study.modes.damping_ratio >= 1.0) {
    table->wrong(*table->find("damping_ratio"),
                 "modes.damping_ratio must be below 1 (a fraction of critical; 0.5 % is 0.005)");
  }
  if (table->has("engine") && !is_plain_engine(study.modes.engine)) {
    table->wrong(
        *table->find("engine"),
        "modes.engine must be mpiexec, mpirun or srun with -n, -np, -N, --ntasks or --nodes "
        "and a number, --oversubscribe or --allow-run-as-root; other words are for the "
        "option --engine");
  }
  refuse_mirrors(*table, study.modes);
  table->refuse_unknown();
}

void read_layouts(TableReader& root, Study& study) {
  Names names("layout");
  for (auto& table : root.tables("layout")) {
    const auto layout = read_part(table, layout_schema());
    names.add(table, layout.name);
    refuse_strangers(table, "sensors", "sensor of the study", layout.sensors,
                     names_of(study.sensors));
    refuse_strangers(table, "actuators", "actuator of the study", layout.actuators,
                     names_of(study.actuators));
    table.refuse_unknown();
    study.layouts.push_back(layout);
  }
}

}  // namespace chladni::study
