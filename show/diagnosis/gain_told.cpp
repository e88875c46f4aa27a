#include "show/diagnosis/gain_told.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/percent.h"

namespace chladni::show {
namespace {

using diagnosis::CrossValidation;
using Kind = diagnosis::HeldOutPart::Kind;

constexpr std::array<std::pair<Kind, std::string_view>, 3> kKinds = {
    {{Kind::sensors, "sensors"}, {Kind::lines, "lines"}, {Kind::upper_band, "upper_band"}}};

std::string_view name(Kind kind) { return kKinds[static_cast<std::size_t>(kind)].second; }

bool is_changed(const steps::Gain& gain) { return gain.from != steps::GainFrom::nothing; }

// A row of relative errors.
struct Row {
  std::string what;
  double before = 0.0, after = 0.0, noise = 0.0;
  std::string of;
};

// "s1; s2; s3" or "20 to 97 Hz; 97 to 203 Hz".
std::string parts_in_words(const CrossValidation& tested, Kind kind) {
  std::string text;
  for (const auto& part : tested.parts) {
    if (part.kind == kind) text += (text.empty() ? "" : "; ") + steps::words(part);
  }
  return text;
}

void add_parts(const CrossValidation& tested, std::vector<Row>& rows) {
  constexpr std::array<std::string_view, 3> kHeads{"each sensor in turn", "lines in turn",
                                                   "upper band"};
  for (const auto& [kind, key] : kKinds) {
    const auto errors = tested.errors(kind);
    if (!(errors.size > 0.0)) continue;
    rows.push_back({std::string(kHeads[static_cast<std::size_t>(kind)]),
                    errors.relative(errors.before), errors.relative(errors.after),
                    errors.relative(errors.noise), parts_in_words(tested, kind)});
  }
}

std::vector<Row> rows_of(const steps::Diagnosed& one) {
  const auto& gain = one.gain;
  const double none = steps::Gain::kNone;
  std::vector<Row> rows{{"fitted", gain.fit_before, is_changed(gain) ? gain.fit_after : none,
                         gain.noise_floor, steps::words(gain.fitted)}};
  if (!gain.held_out.empty() && !gain.in_turn) {
    rows.push_back({"held out", gain.held_out_before, is_changed(gain) ? gain.held_out_after : none,
                    gain.held_out_noise, fmt::format("{}", fmt::join(gain.held_out, ", "))});
  }
  if (one.result.cross_validation) add_parts(*one.result.cross_validation, rows);
  return rows;
}

io::Json bands_json(const std::vector<std::pair<double, double>>& bands) {
  io::JsonArray array;
  for (const auto& [low, high] : bands) array.push_back(io::JsonArray{low, high});
  return array;
}

// NaN where no part of that kind was held out.
double gain_of(const CrossValidation& tested, Kind kind) {
  const bool any = std::ranges::count(tested.parts, kind, &diagnosis::HeldOutPart::kind) > 0;
  return any ? tested.gain(kind) : std::nan("");
}

// "within noise and tolerances the causes explain held-out data better by 12 (sensors) ..."; empty
// where neither sensors nor lines were held out.
std::string likelihood_line(const CrossValidation& tested) {
  std::vector<std::string> gains;
  for (const auto& [kind, word] : kKinds) {
    const double gain = kind == Kind::upper_band ? NAN : gain_of(tested, kind);
    if (std::isfinite(gain)) gains.push_back(fmt::format("{:.3g} ({})", gain, word));
  }
  if (gains.empty()) return "";
  return fmt::format(
      "within noise and tolerances the causes explain held-out data better by {} in ln "
      "likelihood{}",
      fmt::join(gains, " and "), tested.pays() ? "" : ": they do not pay");
}

io::JsonObject cross_validation_json(const CrossValidation& tested) {
  io::JsonArray parts;
  for (const auto& part : tested.parts) {
    const auto& errors = part.errors;
    parts.emplace_back(io::JsonObject{{"kind", std::string(name(part.kind))},
                                      {"sensors", io::Json::texts(part.sensors)},
                                      {"band_hz", io::JsonArray{part.low_hz, part.high_hz}},
                                      {"before", errors.relative(errors.before)},
                                      {"after", errors.relative(errors.after)},
                                      {"noise_floor", errors.relative(errors.noise)},
                                      {"log_likelihood_gain", part.gain}});
  }
  io::JsonObject json{{"pays", tested.pays()}};
  for (const auto& [kind, key] : kKinds) {
    json.emplace_back(fmt::format("log_likelihood_gain_{}", key), gain_of(tested, kind));
  }
  json.emplace_back("parts", std::move(parts));
  return json;
}

}  // namespace

io::ResultTable gain_table(const steps::Diagnosed& one) {
  std::vector<std::string> what, before, after, noise, of;
  for (const auto& row : rows_of(one)) {
    what.push_back(row.what);
    before.push_back(percent(row.before));
    after.push_back(percent(row.after));
    noise.push_back(percent(row.noise));
    of.push_back(row.of);
  }
  io::ResultTable table{"Relative error of the predicted responses",
                        {io::word_column("responses off by", what, 20),
                         io::word_column("before", before, 10), io::word_column("after", after, 10),
                         io::word_column("noise", noise, 10), io::word_column("of", of)}};
  for (auto& column : table.columns) column.gap = 1;
  table.columns.front().gap = 0;
  return table;
}

// Whether the causes pay. The fitted model is asked where no extended study was solved. Causes of
// modes are also judged by frequencies and shapes, which it does not give: it speaks for them
// alone.
std::optional<bool> told_to_pay(const steps::Diagnosed& one) {
  if (one.gain.pays) return one.gain.pays;
  const bool is_doubt = !one.gain.fitted_pays.value_or(true);
  return steps::is_of_modes(one) && is_doubt ? std::nullopt : one.gain.fitted_pays;
}

std::vector<std::string> gain_lines(const steps::Diagnosed& one) {
  const auto& gain = one.gain;
  std::vector<std::string> lines;
  if (gain.from == steps::GainFrom::extended_study) {
    lines.emplace_back("after: the finite elements of extended.toml");
  }
  if (gain.from == steps::GainFrom::fitted_model) {
    lines.emplace_back(
        "after: the reduced model of the fit with all causes (extended.toml lacks one, or was not "
        "solved)");
    const auto pays = told_to_pay(one);
    if (!gain.pays && pays) {
      lines.emplace_back(*pays ? "by it the causes pay" : "by it the causes do not pay");
    }
  }
  if (gain.from == steps::GainFrom::fitted_model && gain.pays) {
    const auto held_out =
        gain.in_turn ? "" : fmt::format(", by {} held out", percent(gain.held_out_extended));
    lines.push_back(fmt::format("extended.toml alone: off by {} fitted{}",
                                percent(gain.fit_extended), held_out));
  }
  const auto add_of_modes = [&](const char* what, double before, double after) {
    if (!std::isfinite(after)) return;
    lines.push_back(fmt::format(
        "the model's errors put resonances beside each other, so {} count as well: off by {} "
        "before, {} after",
        what, percent(before), percent(after)));
  };
  add_of_modes("frequencies", gain.frequencies_before, gain.frequencies_after);
  add_of_modes("shapes", gain.shapes_before, gain.shapes_after);
  const auto& tested = one.result.cross_validation;
  const bool is_unseen = tested || !gain.held_out.empty();
  if (steps::is_of_modes(one) && is_changed(gain) && !is_unseen) {
    lines.emplace_back(
        "nothing was held out: the causes are those of the modes, which are of all responses");
  }
  if (!tested) return lines;
  lines.emplace_back(
      "in turn: the reduced model, the numbers of the causes fitted to all other data");
  if (auto line = likelihood_line(*tested); !line.empty()) lines.push_back(std::move(line));
  return lines;
}

std::string gain_text(const steps::Diagnosed& one) {
  std::string text = "\n" + io::text(gain_table(one));
  for (const auto& line : gain_lines(one)) text += "  " + line + "\n";
  return text;
}

io::JsonObject gain_json(const steps::Diagnosed& one) {
  const auto& gain = one.gain;
  const auto pays = told_to_pay(one);
  io::JsonObject json{
      {"from", is_changed(gain) ? io::Json(std::string(steps::name(gain.from))) : io::Json()},
      {"fit", io::JsonObject{{"before", gain.fit_before}, {"after", gain.fit_after}}},
      {"held_out",
       io::JsonObject{{"before", gain.held_out_before}, {"after", gain.held_out_after}}},
      {"fitted", io::JsonObject{{"sensors", io::Json::texts(gain.fitted.sensors)},
                                {"actuators", io::Json::texts(gain.fitted.actuators)},
                                {"bands_hz", bands_json(gain.fitted.bands_hz)},
                                {"lines", static_cast<long long>(gain.fitted.lines)}}},
      {"held_out_channels", io::Json::texts(gain.held_out)},
      {"held_out_bands_hz", bands_json(gain.held_out_band_hz)},
      {"held_out_in_turn", gain.in_turn},
      {"noise_floor", gain.noise_floor},
      {"held_out_noise_floor", gain.held_out_noise},
      {"pays", pays ? io::Json(*pays) : io::Json()}};
  if (gain.from == steps::GainFrom::fitted_model && gain.pays) {
    json.emplace_back("extended_study", io::JsonObject{{"fit", gain.fit_extended},
                                                       {"held_out", gain.held_out_extended}});
  }
  if (std::isfinite(gain.frequencies_after)) {
    json.emplace_back("frequencies", io::JsonObject{{"before", gain.frequencies_before},
                                                    {"after", gain.frequencies_after}});
  }
  if (std::isfinite(gain.shapes_after)) {
    json.emplace_back("shapes",
                      io::JsonObject{{"before", gain.shapes_before}, {"after", gain.shapes_after}});
  }
  const auto& tested = one.result.cross_validation;
  if (tested) json.emplace_back("cross_validation", cross_validation_json(*tested));
  const auto advice = steps::advice_against(gain);
  if (!advice.empty()) json.emplace_back("advice", advice);
  return json;
}

}  // namespace chladni::show
