// A comparison as a table and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/percent.h"
#include "show/comparison.h"
#include "show/readable.h"
#include "show/solution.h"

namespace chladni::show {
namespace {

using diagnosis::Comparison;
using diagnosis::ModeComparison;
using diagnosis::ResponseComparison;

std::string row(const diagnosis::ModeDifference& pair) {
  return fmt::format(
      "{:>12.3f} {:>24} {:>20} {:>10.5f} {:>22} {:>7.3f} {}\n", pair.simulated_hz,
      fmt::format("{:.4f} +- {}", pair.measured_hz, deviation_text(pair.measured_std_hz)),
      fmt::format("{:+.3f} +- {} %", 100.0 * pair.change,
                  deviation_text(100.0 * pair.change_std, "{:.1g}")),
      pair.simulated_damping,
      fmt::format("{:.6f} +- {}", pair.measured_damping,
                  deviation_text(pair.measured_damping_std, "{:.1g}")),
      pair.mac, pair.by_shape ? "shape" : "frequency");
}

std::string modes_text(const ModeComparison& modes) {
  std::string text;
  if (modes.pairs.empty()) return text;
  text = fmt::format("{:>12} {:>24} {:>20} {:>10} {:>22} {:>7} {}\n", "simulated Hz", "measured Hz",
                     "difference", "damping", "measured", "MAC", "paired by");
  for (const auto& pair : modes.pairs) text += row(pair);
  return text;
}

std::string frequencies_of(const std::vector<diagnosis::ModeAlone>& modes) {
  std::string text;
  for (const auto& mode : modes) {
    text += fmt::format("{}{:.5g} Hz", text.empty() ? "" : ", ", mode.frequency_hz);
    if (!mode.why.empty()) text += " (" + mode.why + ")";
  }
  return text;
}

std::string alone_text(const ModeComparison& modes) {
  std::string text;
  for (const auto& line : unpaired_lines(modes)) text += line + "\n";
  return text.empty() ? text : text + "\n";
}

// Mean error of the responses of a row or column, because their joint error is not stored.
double mean_of(const Eigen::VectorXd& errors) {
  double sum = 0.0;
  int count = 0;
  for (const double error : errors) {
    if (!std::isfinite(error)) continue;
    sum += error;
    ++count;
  }
  return count > 0 ? sum / count : std::nan("");
}

std::string channel_line(const std::string& name, double error, double gain, double sign,
                         double comac) {
  return fmt::format("{:>16} {:>12} {:>10} {:>6} {:>8}\n", name, percent(error),
                     std::isfinite(gain) ? fmt::format("{:.4f}", gain) : "-",
                     std::isfinite(sign) ? (sign < 0.0 ? "-" : "+") : "?",
                     std::isfinite(comac) ? fmt::format("{:.3f}", comac) : "-");
}

double at(const Eigen::VectorXd& values, Eigen::Index i) {
  return i < values.size() ? values(i) : std::nan("");
}

std::string channels_text(const Comparison& comparison) {
  const auto& r = comparison.responses;
  const auto& modes = comparison.modes;
  std::string text = fmt::format("\n{:>16} {:>12} {:>10} {:>6} {:>8}\n", "channel", "error", "gain",
                                 "sign", "CoMAC");
  for (std::size_t k = 0; k < r.outputs.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    text += channel_line(r.outputs[k], mean_of(r.error.row(i).transpose()), r.output_gain(i),
                         r.output_sign(i), at(modes.output_comac, i));
  }
  for (std::size_t k = 0; k < r.inputs.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    text += channel_line(r.inputs[k], mean_of(r.error.col(j)), r.input_gain(j), r.input_sign(j),
                         at(modes.input_comac, j));
  }
  return text;
}

std::string bands_text(const ResponseComparison& r) {
  std::string text;
  for (Eigen::Index b = 0; b < r.band_error.size(); ++b) {
    if (!std::isfinite(r.band_error(b))) continue;
    text += fmt::format("{:>10.4g} to {:>8.4g} Hz {:>12}\n", r.band_edges_hz(b),
                        r.band_edges_hz(b + 1), percent(r.band_error(b)));
  }
  return text;
}

std::string swaps_text(const Comparison& comparison) {
  std::string text;
  for (const auto& swap : comparison.swaps) {
    const auto& names = swap.outputs ? comparison.responses.outputs : comparison.responses.inputs;
    text +=
        fmt::format("{} and {} look exchanged: likeness {:.3f}, exchanged {:.3f}\n",
                    names[static_cast<std::size_t>(swap.first)],
                    names[static_cast<std::size_t>(swap.second)], swap.alike, swap.alike_exchanged);
  }
  return text;
}

std::string reciprocity_text(const Comparison& comparison) {
  const auto& all = comparison.reciprocity;
  if (all.empty()) return {};
  const auto worst = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.difference < b.difference;
  });
  const auto& r = comparison.responses;
  return fmt::format(
      "{} pairs of collocated pairs; least reciprocal: {}/{} and {}/{} differ by {}, "
      "noise {}, ratio {:.4f}\n",
      all.size(), r.outputs[static_cast<std::size_t>(worst->output_a)],
      r.inputs[static_cast<std::size_t>(worst->input_b)],
      r.outputs[static_cast<std::size_t>(worst->output_b)],
      r.inputs[static_cast<std::size_t>(worst->input_a)], percent(worst->difference),
      percent(worst->noise), worst->ratio);
}

io::Json modes_json(const ModeComparison& modes) {
  io::JsonArray pairs;
  for (const auto& pair : modes.pairs) {
    pairs.push_back(io::JsonObject{{"simulated_mode", static_cast<long long>(pair.simulated + 1)},
                                   {"measured_mode", static_cast<long long>(pair.measured + 1)},
                                   {"simulated_hz", pair.simulated_hz},
                                   {"measured_hz", pair.measured_hz},
                                   {"measured_std_hz", pair.measured_std_hz},
                                   {"change", pair.change},
                                   {"change_std", pair.change_std},
                                   {"simulated_damping", pair.simulated_damping},
                                   {"measured_damping", pair.measured_damping},
                                   {"measured_damping_std", pair.measured_damping_std},
                                   {"mac", pair.mac},
                                   {"paired_by", pair.by_shape ? "shape" : "frequency"}});
  }
  return pairs;
}

io::Json list(const std::vector<Eigen::Index>& modes) {
  io::JsonArray array;
  for (const auto mode : modes) array.emplace_back(static_cast<long long>(mode + 1));
  return array;
}

io::Json alone_json(const std::vector<diagnosis::ModeAlone>& modes) {
  io::JsonArray array;
  for (const auto& mode : modes) {
    io::JsonObject json{{"mode", static_cast<long long>(mode.column + 1)},
                        {"frequency_hz", mode.frequency_hz}};
    if (!mode.why.empty()) json.emplace_back("why", mode.why);
    array.emplace_back(std::move(json));
  }
  return array;
}

io::Json side_json(const std::vector<std::string>& names, const Eigen::MatrixXd& errors,
                   const Eigen::VectorXd& gain, const Eigen::VectorXd& sign,
                   const Eigen::VectorXd& comac, const Eigen::MatrixXd& bands) {
  io::JsonArray array;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    array.push_back(io::JsonObject{{"name", names[k]},
                                   {"relative_error", mean_of(errors.row(i).transpose())},
                                   {"gain", gain(i)},
                                   {"sign", sign(i)},
                                   {"comac", at(comac, i)},
                                   {"band_error", io::Json(Eigen::VectorXd(bands.row(i)))}});
  }
  return array;
}

io::Json swaps_json(const Comparison& comparison) {
  io::JsonArray array;
  for (const auto& swap : comparison.swaps) {
    const auto& names = swap.outputs ? comparison.responses.outputs : comparison.responses.inputs;
    array.push_back(io::JsonObject{
        {"side", swap.outputs ? "sensors" : "actuators"},
        {"channels", io::Json::texts({names[static_cast<std::size_t>(swap.first)],
                                      names[static_cast<std::size_t>(swap.second)]})},
        {"alike", swap.alike},
        {"alike_exchanged", swap.alike_exchanged}});
  }
  return array;
}

io::Json reciprocity_json(const Comparison& comparison) {
  const auto& r = comparison.responses;
  io::JsonArray array;
  for (const auto& one : comparison.reciprocity) {
    array.push_back(io::JsonObject{{"sensor_a", r.outputs[static_cast<std::size_t>(one.output_a)]},
                                   {"actuator_a", r.inputs[static_cast<std::size_t>(one.input_a)]},
                                   {"sensor_b", r.outputs[static_cast<std::size_t>(one.output_b)]},
                                   {"actuator_b", r.inputs[static_cast<std::size_t>(one.input_b)]},
                                   {"difference", one.difference},
                                   {"noise", one.noise},
                                   {"ratio", one.ratio},
                                   {"left", one.left}});
  }
  return array;
}

}  // namespace

std::vector<std::string> unpaired_lines(const ModeComparison& modes) {
  std::vector<std::string> lines;
  const auto add = [&](const char* what, const std::vector<diagnosis::ModeAlone>& alone) {
    if (!alone.empty()) lines.push_back(what + frequencies_of(alone));
  };
  add("simulated within the band, without a measured partner: ", modes.simulated_alone);
  add("simulated within the band, hardly seen by these channels: ", modes.simulated_unseen);
  add("measured, without a simulated partner: ", modes.measured_alone);
  add("poles of the fit that are no modes of the band: ", modes.no_modes);
  if (!modes.shapes_tell) {
    lines.push_back(fmt::format(
        "these channels do not tell the shapes apart (MAC between different simulated modes {:.2g} "
        "in the mean): modes are paired by frequency alone",
        modes.confusion));
  }
  return lines;
}

std::string comparison_table(const Comparison& comparison) {
  const auto& r = comparison.responses;
  std::string text = modes_text(comparison.modes) + alone_text(comparison.modes);
  text += fmt::format("responses off by {} of their size, noise {}; level {:.4f}\n",
                      percent(r.overall_error), percent(r.overall_noise), r.level);
  return text + bands_text(r) + channels_text(comparison) + swaps_text(comparison) +
         reciprocity_text(comparison);
}

io::Json per_channel_json(const ResponseComparison& r) {
  io::JsonArray array;
  for (std::size_t j = 0; j < r.inputs.size(); ++j) {
    for (std::size_t i = 0; i < r.outputs.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      array.push_back(io::JsonObject{{"sensor", r.outputs[i]},
                                     {"actuator", r.inputs[j]},
                                     {"relative_error", r.error(row, column)},
                                     {"noise_floor", r.noise(row, column)},
                                     {"frac", r.frac(row, column)},
                                     {"chi_square", r.chi_square(row, column)},
                                     {"lag_one", r.lag_one(row, column)}});
    }
  }
  return array;
}

io::JsonObject comparison_json(const Comparison& comparison) {
  const auto& r = comparison.responses;
  const auto& modes = comparison.modes;
  return {{"modes", modes_json(modes)},
          {"band_hz", io::Json(Eigen::VectorXd(Eigen::Vector2d(modes.low_hz, modes.high_hz)))},
          {"shapes_tell", modes.shapes_tell},
          {"simulated_alone", alone_json(modes.simulated_alone)},
          {"simulated_unseen", alone_json(modes.simulated_unseen)},
          {"measured_alone", alone_json(modes.measured_alone)},
          {"no_modes", alone_json(modes.no_modes)},
          {"mac", io::JsonObject{{"simulated_modes", list(modes.simulated_modes)},
                                 {"measured_modes", list(modes.measured_modes)},
                                 {"value", io::Json::rows(modes.mac)}}},
          {"relative_error", r.overall_error},
          {"noise_floor", r.overall_noise},
          {"level", r.level},
          {"band_edges_hz", io::Json(r.band_edges_hz)},
          {"band_error", io::Json(r.band_error)},
          {"sensors", side_json(r.outputs, r.error, r.output_gain, r.output_sign,
                                modes.output_comac, r.output_band_error)},
          {"actuators", side_json(r.inputs, r.error.transpose(), r.input_gain, r.input_sign,
                                  modes.input_comac, r.input_band_error)},
          {"per_channel", per_channel_json(r)},
          {"exchanged", swaps_json(comparison)},
          {"reciprocity", reciprocity_json(comparison)}};
}

}  // namespace chladni::show
