// A diagnosis as a table for a person and as JSON.
#include <fmt/format.h>

#include <cmath>

#include "app/comparison.h"
#include "app/detectable_text.h"
#include "app/diagnosis.h"
#include "app/percent.h"
#include "app/readable.h"

namespace chladni::app {
namespace {

// A value with its deviation in a unit that people read.
std::string quantity(const diagnosis::CauseParameter& one) {
  const auto [scale, unit] = readable(one.name, one.unit, one.value);
  return fmt::format("{} {:.4g} +- {:.2g}{}{}", one.name, scale * one.value, scale * one.std,
                     unit.empty() ? "" : " ", unit);
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
  if (one.place) {
    text += fmt::format(" at ({:.1f}, {:.1f}) mm", 1e3 * (*one.place)(0), 1e3 * (*one.place)(1));
  }
  return text + fmt::format(": {:.0f} % of what is left", 100.0 * one.explained);
}

io::JsonObject json_of(const diagnosis::Cause& cause) {
  io::JsonObject parameters;
  for (const auto& one : cause.parameters) {
    parameters.emplace_back(
        one.name, io::JsonObject{{"value", one.value}, {"std", one.std}, {"unit", one.unit}});
  }
  return {{"effect", cause.effect},           {"channels", io::Json::texts(cause.channels)},
          {"parameters", parameters},         {"log_evidence_gain", cause.log_evidence_gain},
          {"probability", cause.probability}, {"share", cause.share}};
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

io::JsonObject discrepancy_json(const Diagnosed& one) {
  auto json = comparison_json(one.comparison);
  json.emplace_back("excess", one.result.excess_before);
  json.emplace_back("chi_square_per_sensor", io::Json(one.result.before.per_output));
  json.emplace_back("chi_square_per_actuator", io::Json(one.result.before.per_input));
  json.emplace_back("chi_square_band_edges_hz", io::Json(one.result.before.band_edges_hz));
  json.emplace_back("chi_square_per_band", io::Json(one.result.before.per_band));
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

io::JsonObject gain_json(const Gain& gain) {
  return {{"fit", io::JsonObject{{"before", gain.fit_before}, {"after", gain.fit_after}}},
          {"held_out",
           io::JsonObject{{"before", gain.held_out_before}, {"after", gain.held_out_after}}},
          {"held_out_channels", io::Json::texts(gain.held_out)},
          {"noise_floor", gain.noise_floor},
          {"held_out_noise_floor", gain.held_out_noise},
          {"pays", gain.pays}};
}

}  // namespace

std::string cause_text(const diagnosis::Cause& cause) {
  std::string text = cause.effect;
  if (!cause.channels.empty()) text += fmt::format(" of {}", fmt::join(cause.channels, ", "));
  std::string numbers;
  for (const auto& one : cause.parameters) {
    numbers += (numbers.empty() ? "" : ", ") + quantity(one);
  }
  return numbers.empty() ? text : text + ": " + numbers;
}

std::string verdict_text(const diagnosis::Diagnosis& result) {
  switch (result.verdict) {
    case diagnosis::Verdict::no_discrepancy:
      return "The simulation agrees with what was measured, within noise and tolerances.";
    case diagnosis::Verdict::named:
      return "Named, down to the noise: " + explanation_text(result.best) + ".";
    case diagnosis::Verdict::ambiguous:
      return "Two or more explanations are equally good; the likeliest: " +
             explanation_text(result.best) + ".";
    case diagnosis::Verdict::partial:
      return "Much of it, not all: " + explanation_text(result.best) +
             ". Something more is at work.";
    case diagnosis::Verdict::unexplained:
      break;
  }
  return "None of the known causes explains it.";
}

std::string diagnosis_table(const Diagnosed& one) {
  std::string text = comparison_table(one.comparison);
  text += fmt::format("\nverdict: {}\n{}\n", diagnosis::name(one.result.verdict),
                      verdict_text(one.result));
  const auto& result = one.result;
  text += fmt::format("\nmisfit over noise and tolerances: z = {:.1f} before, {:.1f} after\n",
                      result.excess_before, result.best.excess);
  for (const auto& cause : result.best.causes) {
    text += fmt::format(
        "  {}\n    probability {:.3f}, ln evidence {:.1f}, {:.1f} % of the misfit\n",
        cause_text(cause), cause.probability, cause.log_evidence_gain, 100.0 * cause.share);
  }
  if (result.superclass) text += "  unknown, in: " + superclass_text(*result.superclass) + "\n";
  int shown = 0;
  for (const auto& rival : result.rivals) {
    if (rival.causes.empty()) continue;
    if (++shown > 3) break;
    text += fmt::format("  instead: {} (probability {:.2g})\n", explanation_text(rival),
                        rival.probability);
  }
  for (const auto& note : result.notes) text += "note: " + note + "\n";
  if (!result.measure_next.empty()) text += "measure next: " + result.measure_next + "\n";
  for (const auto& breach : result.breaches) text += "  beyond its tolerance: " + breach + "\n";
  const auto& gain = one.gain;
  text += fmt::format(
      "\nresponses              before     after      noise\n"
      "  seen by the fit      {:<10} {:<10} {}\n",
      percent(gain.fit_before), percent(gain.fit_after), percent(gain.noise_floor));
  if (!gain.held_out.empty()) {
    text += fmt::format("  held out             {:<10} {:<10} {}\n", percent(gain.held_out_before),
                        percent(gain.held_out_after), percent(gain.held_out_noise));
  }
  if (const auto sizes = detectable_table(one.detectable); !sizes.empty()) text += "\n" + sizes;
  if (one.extended) {
    for (const auto& line : one.extended->unexpressed)
      text += "  not in extended.toml: " + line + "\n";
  }
  return text;
}

io::JsonObject diagnosis_json(const Diagnosed& one) {
  const auto& result = one.result;
  io::JsonObject json{{"verdict", std::string(diagnosis::name(result.verdict))},
                      {"summary", verdict_text(result)},
                      {"discrepancy", discrepancy_json(one)},
                      {"causes", json_of(result.best.causes)},
                      {"alternatives", alternatives_json(result)},
                      {"measure_next", result.measure_next},
                      {"excess_after", result.best.excess},
                      {"gain", gain_json(one.gain)},
                      {"detectable", detectable_json(one.detectable)},
                      {"breaches", io::Json::texts(result.breaches)},
                      {"notes", io::Json::texts(result.notes)}};
  if (result.superclass) json.emplace_back("superclass", superclass_json(*result.superclass));
  return json;
}

}  // namespace chladni::app
