// Trust in an identified model, as text and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "identification/constants.h"
#include "show/identification.h"

namespace chladni::show {
namespace {

constexpr std::size_t kMostLines = 8;  // named on the terminal

std::string response_name(const steps::IdentifiedModel& model, Eigen::Index e) {
  const auto p = model.data.outputs;
  return model.seen.outputs[static_cast<std::size_t>(e % p)].name + "/" +
         model.seen.inputs[static_cast<std::size_t>(e / p)].name;
}

// The outlying values of each line, the worst first; so are the lines.
std::vector<std::vector<identification::OutlyingValue>> outlying_lines(
    std::vector<identification::OutlyingValue> values) {
  std::ranges::stable_sort(values, std::ranges::greater(),
                           &identification::OutlyingValue::residual);
  std::vector<std::vector<identification::OutlyingValue>> lines;
  for (const auto& value : values) {
    const auto same =
        std::ranges::find(lines, value.line, [](const auto& line) { return line.front().line; });
    if (same == lines.end()) {
      lines.push_back({value});
    } else {
      same->push_back(value);
    }
  }
  return lines;
}

std::string outlying_text(const steps::IdentifiedModel& model) {
  const auto lines = outlying_lines(model.judgement.outlying);
  std::string text;
  std::size_t count = 0;
  for (const auto& values : lines) {
    if (count++ == kMostLines) {
      text += fmt::format("  and {} more lines\n", lines.size() - kMostLines);
      break;
    }
    const auto& worst = values.front();
    text += fmt::format(
        "  outlying at {:.6g} Hz: {} by {:.3g} deviations ({:.2g} beside it){}\n",
        model.data.frequency_hz(worst.line), response_name(model, worst.response), worst.residual,
        worst.neighbours,
        values.size() > 1 ? fmt::format(", and {} more responses", values.size() - 1) : "");
  }
  return text;
}

// Size of the residual, and what it is compared with.
std::string left_text(const steps::IdentifiedModel& model) {
  const auto& judgement = model.judgement;
  const auto& data = model.data;
  const auto against = data.noise_known    ? "the stated noise's"
                       : data.noise_stated ? "those of the noise and the stated error of the model"
                                           : "those of the noise and of an error of the model that "
                                             "are assumed";
  const bool open = !data.freedom_known && judgement.level > 1.0;
  auto text = fmt::format("squares of what is left are {:.3g} times {}", judgement.level, against);
  if (open) {
    text += fmt::format(" (of how many averages is not stated: up to {:.2g} may be noise)",
                        identification::Constants::good_level);
  }
  return text;
}

std::string beyond_text(const steps::IdentifiedModel& model) {
  std::string list;
  for (const auto mode : model.judgement.beyond_lines) {
    list += fmt::format("{}{} ({:.0f} Hz)", list.empty() ? "" : ", ", mode + 1,
                        model.found.fit.model.frequency_hz(mode));
  }
  if (list.empty()) return "";
  return "  beyond the lines: mode " + list +
         "; what all modes there add is measured, these modes are not "
         "(left out of identified.unv and identified_shapes.csv)\n";
}

std::string complex_text(const identification::ComplexAlternative& complex) {
  return fmt::format(
      "complex shapes explain the data better: {:.3g} times with {} modes instead of {}; damping "
      "couples the modes, set identification.damping = \"general\"",
      complex.level, complex.modes, complex.instead);
}

io::Json complex_json(const std::optional<identification::ComplexAlternative>& complex) {
  if (!complex) return {};
  return io::JsonObject{{"noise_level", complex->level},
                        {"modes", static_cast<long long>(complex->modes)},
                        {"instead_of", static_cast<long long>(complex->instead)}};
}

}  // namespace

std::string trust_text(const steps::IdentifiedModel& model) {
  const auto& judgement = model.judgement;
  std::string text = fmt::format("trust: {}; {}\n", word(judgement.trust), left_text(model));
  for (const auto& reason : judgement.reasons) text += "  " + reason + "\n";
  if (judgement.with_complex_shapes)
    text += "  " + complex_text(*judgement.with_complex_shapes) + "\n";
  for (const auto& one : judgement.doubtful) {
    text += fmt::format("  mode {} ({:.4f} Hz): {}\n", one.mode + 1,
                        model.found.fit.model.frequency_hz(one.mode), one.why);
  }
  return text + beyond_text(model) + outlying_text(model);
}

io::Json trust_json(const steps::IdentifiedModel& model) {
  const auto& judgement = model.judgement;
  io::JsonArray outlying;
  for (const auto& one : judgement.outlying) {
    const auto p = model.data.outputs;
    outlying.push_back(io::JsonObject{
        {"frequency_hz", model.data.frequency_hz(one.line)},
        {"sensor", model.seen.outputs[static_cast<std::size_t>(one.response % p)].name},
        {"actuator", model.seen.inputs[static_cast<std::size_t>(one.response / p)].name},
        {"residual", one.residual},
        {"neighbours", one.neighbours}});
  }
  io::JsonArray doubtful;
  for (const auto& one : judgement.doubtful) {
    doubtful.push_back(
        io::JsonObject{{"mode", static_cast<long long>(one.mode + 1)}, {"why", one.why}});
  }
  io::JsonArray beyond;
  for (const auto mode : judgement.beyond_lines) {
    beyond.emplace_back(static_cast<long long>(mode + 1));
  }
  return io::JsonObject{{"verdict", word(judgement.trust)},
                        {"trusted", judgement.trust != identification::Trust::none},
                        {"reasons", io::Json::texts(judgement.reasons)},
                        {"noise_level", judgement.level},
                        {"excess", model.found.fit.excess()},
                        {"unexplained", judgement.unexplained},
                        {"doubtful_part", judgement.doubtful_part},
                        {"doubtful_modes", doubtful},
                        {"beyond_lines", beyond},
                        {"outlying", outlying},
                        {"with_complex_shapes", complex_json(judgement.with_complex_shapes)}};
}

}  // namespace chladni::show
