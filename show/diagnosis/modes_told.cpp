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

bool in_both(const ModeTold& mode) { return std::isfinite(mode.reference_hz); }

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
  for (const auto& proposal : proposals) {
    io::JsonObject json{{"what", std::string(diagnosis::name(proposal.what))},
                        {"in_words", diagnosis::in_words(proposal)},
                        {"log_evidence", proposal.evidence},
                        {"cost", proposal.cost}};
    if (!proposal.of.empty()) json.emplace_back("of", proposal.of);
    if (proposal.place) json.emplace_back("place_m", io::Json(Eigen::VectorXd(*proposal.place)));
    if (proposal.mass > 0.0) json.emplace_back("mass_kg", proposal.mass);
    array.emplace_back(std::move(json));
  }
  return array;
}

io::ResultTable modes_told_table(const std::vector<ModeTold>& modes, bool has_causes) {
  const auto values = [&](double ModeTold::*value) {
    Eigen::VectorXd column(std::ssize(modes));
    for (std::size_t i = 0; i < modes.size(); ++i) {
      column(static_cast<Eigen::Index>(i)) = modes[i].*value;
    }
    return column;
  };
  const Eigen::VectorXd measured = values(&ModeTold::measured_hz);
  const auto off = [&](const Eigen::VectorXd& frequency) {
    return Eigen::VectorXd(frequency.array() / measured.array() - 1.0);
  };
  const io::NumberFormat hertz{"{:.3f}"}, share{"{:.3f}"}, percent{"{:+.2f}", 100.0};
  const Eigen::VectorXd before = values(&ModeTold::before_hz);
  const Eigen::VectorXd after = values(&ModeTold::after_hz);
  io::ResultTable table{
      "Measured and simulated modes",
      {io::number_column("measured", "Hz", measured, hertz, 13, "measured_hz"),
       io::number_column("before", "Hz", before, hertz, 11, "before_hz"),
       io::number_column("off", "%", off(before), percent, 7),
       io::number_column("MAC", "", values(&ModeTold::mac_before), share, 7, "mac_before"),
       io::number_column("after", "Hz", after, hertz, 11, "after_hz"),
       io::number_column("off", "%", off(after), percent, 7),
       io::number_column("MAC", "", values(&ModeTold::mac_after), share, 7, "mac_after"),
       io::json_column("reference_hz", values(&ModeTold::reference_hz))}};
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    table.columns[i].gap = i == 0 ? 0 : 1;
    if (i >= 4) table.columns[i].is_shown = has_causes && i < 7;
  }
  const Eigen::VectorXd deviation = values(&ModeTold::measured_std_hz);
  if (!deviation.array().isFinite().any()) return table;
  auto column = io::number_column("+-", "Hz", deviation, {"{:.2g}"}, 9, "measured_std_hz");
  column.gap = 1;
  table.columns.insert(table.columns.begin() + 1, std::move(column));
  return table;
}

std::string modes_told_text(const std::vector<ModeTold>& modes, bool has_causes) {
  return modes.empty() ? "" : "\n" + io::text(modes_told_table(modes, has_causes));
}

}  // namespace chladni::show
