#include "show/diagnosis/modes_told.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "steps/diagnosis.h"

namespace chladni::show {
namespace {

using diagnosis::ErrorLevel;
using diagnosis::ModeTold;

std::string hertz(double hz) { return std::isfinite(hz) ? fmt::format("{:.3f}", hz) : "-"; }

std::string deviation(double hz, double measured_hz) {
  if (!std::isfinite(hz)) return "-";
  return fmt::format("{:+.2f}", 100.0 * (hz / measured_hz - 1.0));
}

bool in_both(const ModeTold& mode) { return std::isfinite(mode.reference_hz); }

std::string mac(double value) { return std::isfinite(value) ? fmt::format("{:.3f}", value) : "-"; }

}  // namespace

bool has_reference(const diagnosis::Diagnosis& result) {
  return std::ranges::any_of(result.modes, in_both);
}

std::string reference_line(const diagnosis::Diagnosis& result, const std::string& file) {
  if (!has_reference(result)) return "";
  return fmt::format("compared with {}: {} of {} modes are in both", file,
                     std::ranges::count_if(result.modes, in_both), result.modes.size());
}

std::string levels_sentence(const diagnosis::Diagnosis& result) {
  std::string text;
  const std::string first =
      has_reference(result) ? "Before and after, {} agree to" : "The model's {} are good to";
  const std::string next = has_reference(result) ? ", {} to" : ", its {} to";
  for (const auto& [what, level] : steps::told_levels(result.levels_after)) {
    text += fmt::format(fmt::runtime(text.empty() ? first : next), what);
    text += " " + level;
  }
  if (text.empty()) return text;
  const bool beside_causes = !result.modes.empty() && !result.best.causes.empty();
  return text + (beside_causes ? ", once this is in it." : ".");
}

io::JsonObject levels_json(const diagnosis::Diagnosis& result) {
  io::JsonObject json;
  for (const auto& before : result.levels_before) {
    const auto after = std::ranges::find(result.levels_after, before.of, &ErrorLevel::of);
    const bool has_after = after != result.levels_after.end();
    json.emplace_back(before.of,
                      io::JsonObject{{"before", before.value},
                                     {"after", has_after ? io::Json(after->value) : io::Json()},
                                     {"usual", before.usual},
                                     {"at_most", before.at_most}});
  }
  return json;
}

io::JsonArray proposals_json(const std::vector<diagnosis::Proposal>& proposals) {
  io::JsonArray array;
  for (const auto& one : proposals) {
    io::JsonObject json{{"what", std::string(diagnosis::name(one.what))},
                        {"in_words", diagnosis::in_words(one)},
                        {"log_evidence", one.evidence},
                        {"cost", one.cost}};
    if (!one.of.empty()) json.emplace_back("of", one.of);
    if (one.place) json.emplace_back("place_m", io::Json(Eigen::VectorXd(*one.place)));
    if (one.mass > 0.0) json.emplace_back("mass_kg", one.mass);
    array.emplace_back(std::move(json));
  }
  return array;
}

std::string modes_told_text(const std::vector<ModeTold>& modes, bool has_causes) {
  if (modes.empty()) return "";
  std::string text =
      fmt::format("\n{:>13} {:>11} {:>7} {:>7}", "measured [Hz]", "before [Hz]", "off [%]", "MAC");
  if (has_causes) text += fmt::format(" {:>11} {:>7} {:>7}", "after [Hz]", "off [%]", "MAC");
  text += "\n";
  for (const auto& one : modes) {
    text += fmt::format("{:>13} {:>11} {:>7} {:>7}", hertz(one.measured_hz), hertz(one.before_hz),
                        deviation(one.before_hz, one.measured_hz), mac(one.mac_before));
    if (has_causes) {
      text += fmt::format(" {:>11} {:>7} {:>7}", hertz(one.after_hz),
                          deviation(one.after_hz, one.measured_hz), mac(one.mac_after));
    }
    text += "\n";
  }
  return text;
}

io::JsonArray modes_told_json(const std::vector<ModeTold>& modes) {
  io::JsonArray array;
  for (const auto& one : modes) {
    array.emplace_back(io::JsonObject{{"measured_hz", one.measured_hz},
                                      {"before_hz", one.before_hz},
                                      {"after_hz", one.after_hz},
                                      {"reference_hz", one.reference_hz},
                                      {"mac_before", one.mac_before},
                                      {"mac_after", one.mac_after}});
  }
  return array;
}

io::Table modes_told_table(const std::vector<ModeTold>& modes, bool has_causes) {
  io::Table table{"Measured and simulated modes",
                  {{"measured [Hz]"}, {"before [Hz]"}, {"off [%]"}, {"MAC"}},
                  {}};
  if (has_causes) {
    for (const char* head : {"after [Hz]", "off [%]", "MAC"}) table.columns.push_back({head});
  }
  for (const auto& one : modes) {
    std::vector<std::string> row{hertz(one.measured_hz), hertz(one.before_hz),
                                 deviation(one.before_hz, one.measured_hz), mac(one.mac_before)};
    if (has_causes) {
      row.push_back(hertz(one.after_hz));
      row.push_back(deviation(one.after_hz, one.measured_hz));
      row.push_back(mac(one.mac_after));
    }
    table.rows.push_back({std::move(row)});
  }
  return table;
}

}  // namespace chladni::show
