// A diagnosis as a text table and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "base/percent.h"
#include "show/comparison.h"
#include "show/diagnosis.h"
#include "show/diagnosis/constants_told.h"
#include "show/diagnosis/detectable_text.h"
#include "show/diagnosis/errors_told.h"
#include "show/diagnosis/gain_told.h"
#include "show/diagnosis/left_told.h"
#include "show/diagnosis/modes_told.h"
#include "show/readable.h"
#include "steps/diagnosis.h"

namespace chladni::show {
namespace {

constexpr double kTold = 1e-3;  // probability; less likely rivals get no line

// A value with its standard deviation, in a readable unit.
std::string quantity(const diagnosis::CauseParameter& one) {
  const auto [scale, unit] = readable(one.name, one.unit, one.value);
  return fmt::format("{} {:.4g} +- {}{}{}", one.name, scale * one.value,
                     deviation_text(scale * one.std), unit.empty() ? "" : " ", unit);
}

std::string explanation_text(const diagnosis::Explanation& one) {
  if (one.causes.empty()) return "nothing beyond the tolerances";
  std::string text;
  for (const auto& cause : one.causes) text += (text.empty() ? "" : "; and ") + cause_text(cause);
  return text;
}

std::string superclass_text(const diagnosis::Superclass& one) {
  std::string text = one.name;
  if (!one.channel.empty()) text += " " + one.channel;
  if (one.place) text += " at " + diagnosis::place_in_words(*one.place);
  if (!std::isfinite(one.explained)) return text;
  return text + fmt::format(": {:.0f} % of what is left", 100.0 * one.explained);
}

io::JsonObject json_of(const diagnosis::Cause& cause) {
  io::JsonObject parameters;
  const auto add = [&](const std::vector<diagnosis::CauseParameter>& numbers) {
    for (const auto& one : numbers) {
      parameters.emplace_back(
          one.name, io::JsonObject{{"value", one.value}, {"std", one.std}, {"unit", one.unit}});
    }
  };
  add(cause.parameters);
  add(cause.fixed);
  io::JsonObject json{{"effect", cause.effect}, {"channels", io::Json::texts(cause.channels)}};
  if (!cause.truly.empty()) json.emplace_back("truly", io::Json::texts(cause.truly));
  if (!cause.option.empty()) json.emplace_back("option", cause.option);
  json.emplace_back("parameters", parameters);
  json.emplace_back("log_evidence_gain", cause.log_evidence_gain);
  json.emplace_back("probability", cause.probability);
  json.emplace_back("share", cause.share);
  return json;
}

io::JsonArray json_of(const std::vector<diagnosis::Cause>& causes) {
  io::JsonArray array;
  for (const auto& cause : causes) array.emplace_back(json_of(cause));
  return array;
}

io::JsonArray alternatives_json(const diagnosis::Diagnosis& result) {
  io::JsonArray array;
  for (const auto& rival : result.rivals) {
    if (rival.causes.empty()) continue;
    array.emplace_back(io::JsonObject{{"causes", json_of(rival.causes)},
                                      {"log_evidence", rival.log_evidence},
                                      {"probability", rival.probability},
                                      {"measure_next", result.measure_next}});
  }
  return array;
}

io::Json discrepancy_json(const steps::Diagnosed& one) {
  if (one.modes) return {};
  auto json = comparison_json(one.comparison);
  for (auto& [key, value] : misfit_json(one.result.before, one.result.excess_before)) {
    json.emplace_back(key, std::move(value));
  }
  return json;
}

io::JsonObject superclass_json(const diagnosis::Superclass& one) {
  io::JsonObject json{{"name", one.name}, {"channel", one.channel}, {"explained", one.explained}};
  if (one.place) json.emplace_back("place_m", io::Json(Eigen::VectorXd(*one.place)));
  json.emplace_back("frequency_hz", io::Json(one.frequency_hz));
  json.emplace_back("curve_re", io::Json(Eigen::VectorXd(one.curve.real())));
  json.emplace_back("curve_im", io::Json(Eigen::VectorXd(one.curve.imag())));
  return json;
}

std::string name_of(const diagnosis::Cause& cause) {
  if (cause.channels.empty()) return cause.effect;
  return fmt::format("{} of {}", cause.effect, fmt::join(cause.channels, ", "));
}

io::JsonObject by_modes_json(const diagnosis::Diagnosis& result) {
  io::JsonObject json{{"verdict", std::string(diagnosis::name(result.verdict))},
                      {"causes", json_of(result.best.causes)},
                      {"levels", levels_json(result)}};
  if (!result.constants.empty()) json.emplace_back("constants", constants_json(result));
  return json;
}

// Parts of the misfit are known of responses alone.
std::string cause_lines(const diagnosis::Diagnosis& result, bool by_modes) {
  const auto table = causes_table(result);
  const auto& probability = table.columns[1];
  const auto& evidence = table.columns[2];
  const auto& share = table.columns[3];
  std::string text;
  for (std::size_t i = 0; i < table.row_count(); ++i) {
    text += fmt::format("  {}: {} {}, {} {}", name_of(result.best.causes[i]), probability.head,
                        probability.cells[i], evidence.head, evidence.cells[i]);
    text += by_modes ? "\n" : fmt::format(", {} % {}\n", share.cells[i], share.head);
  }
  return text;
}

std::string causes_text(const diagnosis::Diagnosis& result, bool by_modes) {
  std::string text = cause_lines(result, by_modes);
  if (result.superclass) text += "  unknown, in: " + superclass_text(*result.superclass) + "\n";
  int shown = 0;
  for (const auto& rival : result.rivals) {
    if (rival.causes.empty() || rival.probability < kTold) continue;
    if (++shown > 3) break;
    text += fmt::format("  instead: {} (probability {:.2g})\n", explanation_text(rival),
                        rival.probability);
  }
  if (!by_modes) {
    text += fmt::format("  misfit over noise and tolerances: z = {:.1f} before, {:.1f} after\n",
                        result.excess_before, result.best.excess);
  }
  for (const auto& breach : result.breaches) text += "  beyond its tolerance: " + breach + "\n";
  return text;
}

}  // namespace

std::string cause_text(const diagnosis::Cause& cause) {
  const std::string text = name_of(cause);
  std::string numbers = cause.option;
  for (const auto& one : cause.parameters) {
    numbers += (numbers.empty() ? "" : ", ") + quantity(one);
  }
  return numbers.empty() ? text : text + ": " + numbers;
}

io::ResultTable causes_table(const diagnosis::Diagnosis& result) {
  const auto count = std::ssize(result.best.causes);
  std::vector<std::string> names;
  Eigen::VectorXd probability(count), evidence(count), share(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& cause = result.best.causes[static_cast<std::size_t>(i)];
    names.push_back(cause_text(cause));
    probability(i) = cause.probability;
    evidence(i) = cause.log_evidence_gain;
    share(i) = cause.share;
  }
  return {"Causes",
          {io::word_column("cause", names),
           io::number_column("probability", "", probability, {"{:.3f}"}, 0),
           io::number_column("ln evidence", "", evidence, {"{:.1f}"}, 0),
           io::number_column("of the misfit", "%", share, {"{:.1f}", 100.0}, 0)}};
}

std::string verdict_text(const diagnosis::Diagnosis& result) {
  const bool is_of_modes = !result.modes.empty();
  switch (result.verdict) {
    case diagnosis::Verdict::no_discrepancy:
      if (!result.constants.empty()) {
        return std::string("Beyond constants that were not known, which are calibrated, ") +
               (is_of_modes ? "the measured modes give no reason to change the simulation."
                            : "the simulation agrees with what was measured, within noise and "
                              "tolerances.");
      }
      if (has_reference(result)) {
        return "Nothing changed since the reference, beyond what two measurements differ by.";
      }
      if (is_of_modes) return "The measured modes give no reason to change the simulation.";
      return "The simulation agrees with what was measured, within noise and tolerances.";
    case diagnosis::Verdict::named:
      return (is_of_modes ? "Named: " : "Named, down to the noise: ") +
             explanation_text(result.best) + ".";
    case diagnosis::Verdict::ambiguous:
      return "Other explanations are not ruled out; the likeliest: " +
             explanation_text(result.best) + ".";
    case diagnosis::Verdict::partial:
      return "Much of it, not all: " + explanation_text(result.best) +
             ". Something more is at work.";
    case diagnosis::Verdict::unexplained:
      break;
  }
  return "None of the known causes explains it.";
}

std::string verdict_text(const steps::Diagnosed& one) {
  const auto advice = steps::advice_against(one.gain);
  return (advice.empty() ? advice : advice + " ") + verdict_text(one.result);
}

namespace {

// Modes, and errors over frequency and over the body, before and after.
std::string before_and_after(const steps::Diagnosed& one) {
  std::string text;
  if (!steps::is_of_modes(one)) text += modes_told_text(one.modes_compared, one.after.has_value());
  text += "\n" + io::text(errors_table(one.errors));
  for (const auto& line : {place_of_error(one), left_line(one)}) {
    if (!line.empty()) text += line + "\n";
  }
  return text;
}

const std::vector<diagnosis::ModeTold>& modes_of(const steps::Diagnosed& one) {
  return steps::is_of_modes(one) ? one.result.modes : one.modes_compared;
}

// The tables behind a verdict of responses.
std::string tables_behind(const steps::Diagnosed& one, bool all) {
  using diagnosis::Verdict;
  const auto verdict = one.result.verdict;
  const bool is_open = verdict == Verdict::partial || verdict == Verdict::unexplained;
  std::string text;
  if (all) text += before_and_after(one);
  if (all || is_open) text += "\n" + comparison_table(one.comparison);
  const auto sizes =
      all ? detectable_table(one.detectable, one.least_evidence) : detectable_sentence(one);
  if (!sizes.empty()) text += "\n" + sizes;
  if (all) return text;
  if (!sizes.empty()) text += "\n";
  return text + fmt::format(
                    "more with --all and in diagnosis.json: {}the sizes that this experiment "
                    "finds\n",
                    is_open ? "" : "modes, bands and channels compared; ");
}

}  // namespace

std::string diagnosis_table(const steps::Diagnosed& one, bool all) {
  const auto& result = one.result;
  const auto levels = levels_sentence(result);
  std::string text =
      fmt::format("verdict: {}\n{}\n{}{}\n{}", diagnosis::name(result.verdict), verdict_text(one),
                  levels, levels.empty() ? "" : "\n", causes_text(result, steps::is_of_modes(one)));
  text += constants_text(result);
  if (const auto line = reference_line(result, one.reference_file); !line.empty()) {
    text += line + "\n";
  }
  if (!result.measure_next.empty()) text += "measure next: " + result.measure_next + "\n";
  for (const auto& note : result.notes) text += "note: " + note + "\n";
  if (!one.modes) text += gain_text(one);
  text += modes_told_text(result.modes, changes_modes(result));
  if (one.modes && changes_modes(result)) {
    text += one.after ? "  after: the finite elements of extended.toml\n"
                      : "  after: the reduced model of the likeliest explanation\n";
  }
  if (one.extended) {
    for (const auto& line : one.extended->unexpressed) {
      text += "  not in extended.toml: " + line + "\n";
    }
  }
  return one.modes ? text : text + tables_behind(one, all);
}

io::JsonObject diagnosis_json(const steps::Diagnosed& one) {
  const auto& result = one.result;
  io::JsonObject json{{"verdict", std::string(diagnosis::name(result.verdict))},
                      {"summary", verdict_text(one)},
                      {"discrepancy", discrepancy_json(one)},
                      {"causes", json_of(result.best.causes)},
                      {"alternatives", alternatives_json(result)},
                      {"measure_next", result.measure_next},
                      {"proposals", proposals_json(result.proposals)},
                      {"excess_after", result.best.excess},
                      {"left", left_json(one)},
                      {"gain", gain_json(one)},
                      {"detectable", detectable_json(one.detectable)},
                      {"levels", levels_json(result)},
                      {"modes", io::json_rows(modes_told_table(modes_of(one), true))},
                      {"reference", one.reference_file},
                      {"breaches", io::Json::texts(result.breaches)},
                      {"notes", io::Json::texts(result.notes)}};
  if (!result.constants.empty()) json.emplace_back("constants", constants_json(result));
  if (one.extended) {
    json.emplace_back("not_in_extended_study", io::Json::texts(one.extended->unexpressed));
  }
  if (one.by_modes) json.emplace_back("by_modes", by_modes_json(*one.by_modes));
  if (!one.modes) {
    json.emplace_back("errors_over_frequency", errors_json(one.errors));
    json.emplace_back("error_on_body", error_on_body_json(one));
  }
  if (result.superclass) json.emplace_back("superclass", superclass_json(*result.superclass));
  return json;
}

}  // namespace chladni::show
