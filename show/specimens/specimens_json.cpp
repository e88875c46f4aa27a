// A diagnosis of several specimens as JSON.
#include <cmath>
#include <utility>

#include "show/diagnosis/constants_told.h"
#include "show/diagnosis/modes_told.h"
#include "show/specimens.h"

namespace chladni::show {
namespace {

using diagnosis::OddEntry;
using diagnosis::SpecimensExplanation;

io::JsonObject entry_json(const OddEntry& one) {
  return {{"specimen", one.specimen},
          {"key", one.key},
          {"unit", one.unit},
          {"of_study", one.of_study},
          {"value", one.value},
          {"std", one.std},
          {"change", one.change()},
          {"probability", one.probability},
          {"log_evidence", one.log_evidence}};
}

io::JsonArray entries_json(const std::vector<OddEntry>& entries) {
  io::JsonArray array;
  for (const auto& one : entries) array.emplace_back(entry_json(one));
  return array;
}

io::JsonObject explanation_json(const SpecimensExplanation& one) {
  io::JsonObject json{{"entries", entries_json(one.entries)},
                      {"probability", one.probability},
                      {"log_evidence", one.log_evidence}};
  if (!one.unlike.empty()) {
    json.emplace_back("unlike", one.unlike);
    json.emplace_back("unlike_in", one.by_modes ? "frequencies" : "constants");
  }
  return json;
}

io::JsonArray numbers_json(const std::vector<diagnosis::CalibratedNumber>& numbers) {
  io::JsonArray array;
  for (const auto& one : numbers) array.emplace_back(constant_json(one));
  return array;
}

io::JsonArray population_json(const std::vector<diagnosis::PopulationConstant>& population) {
  io::JsonArray array;
  for (const auto& one : population) {
    array.emplace_back(io::JsonObject{{"key", one.name},
                                      {"unit", one.unit},
                                      {"mean", one.mean},
                                      {"std", one.std},
                                      {"spread", one.spread},
                                      {"within_group", one.within_group},
                                      {"determined", one.determined}});
  }
  return array;
}

io::JsonArray all_json(const std::vector<diagnosis::SpecimenTold>& specimens) {
  io::JsonArray array;
  for (const auto& one : specimens) {
    array.emplace_back(io::JsonObject{{"name", one.name},
                                      {"group", one.group},
                                      {"same_as", one.same_as},
                                      {"constants", numbers_json(one.constants)},
                                      {"modes", io::json_rows(modes_told_table(one.modes, true))},
                                      {"scatter", one.scatter}});
  }
  return array;
}

}  // namespace

io::JsonObject specimens_json(const diagnosis::SpecimensDiagnosis& result) {
  io::JsonArray rivals;
  for (const auto& one : result.rivals) rivals.emplace_back(explanation_json(one));
  return {{"verdict", std::string(diagnosis::name(result.verdict))},
          {"summary", verdict_text(result)},
          {"best", explanation_json(result.best)},
          {"alternatives", rivals},
          {"none", result.none},
          {"entries", entries_json(result.entries)},
          {"specimens", all_json(result.specimens)},
          {"population", population_json(result.population)},
          {"levels", io::JsonObject{{"shared", result.shared_error}, {"own", result.own_error}}},
          {"measure_next", result.measure_next},
          {"proposals", proposals_json(result.proposals)},
          {"notes", io::Json::texts(result.notes)}};
}

void leave_specimens(const steps::DiagnosedSpecimens& diagnosed, Run& run) {
  run.leave("diagnosis.json", specimens_json(diagnosed.result), true);
  for (const char* of_one : {"extended.toml", "cause_map.vtu", "cause_map.png"}) {
    run.put_aside(of_one);  // of a diagnosis of one body
  }
}

}  // namespace chladni::show
