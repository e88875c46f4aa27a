// chladni check FILE: prints the content of a file of measured data, and suspect values in it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <span>

#include "app/command.h"
#include "app/command_line/unit_of_data.h"
#include "base/upper_median.h"
#include "io/frf_file.h"
#include "io/node_shapes.h"
#include "io/time_file.h"
#include "show/version.h"

namespace chladni::app {
namespace {

using Index = Eigen::Index;
constexpr Index kMostShown = 24;  // responses with a line of their own
constexpr std::size_t kMostChannelsShown = 64;
constexpr const char* kKinds[] = {"receptance", "mobility", "accelerance"};

/// The largest value in one response.
struct Largest {
  double size = 0.0, frequency_hz = 0.0;
  double coherence = std::numeric_limits<double>::quiet_NaN();  // the median; NaN: none is stated
  Index lines = 0;
};

Largest largest(const modal::FrfSet& set, Index i, Index j) {
  Largest result;
  std::vector<double> coherence;
  for (Index k = 0; k < set.line_count(); ++k) {
    const auto line = static_cast<std::size_t>(k);
    const double size = std::abs(set.value[line](i, j));
    if (!std::isfinite(size)) continue;
    ++result.lines;
    if (!set.coherence.empty() && std::isfinite(set.coherence[line](i, j))) {
      coherence.push_back(set.coherence[line](i, j));
    }
    if (size <= result.size) continue;
    result.size = size;
    result.frequency_hz = set.frequency_hz(k);
  }
  if (coherence.empty()) return result;
  result.coherence = upper_median(coherence);
  return result;
}

// "each 0.25 Hz", or the range of the steps.
std::string resolution(const Eigen::VectorXd& frequency_hz) {
  const Index count = frequency_hz.size();
  if (count < 2) return "";
  const Eigen::VectorXd steps = frequency_hz.tail(count - 1) - frequency_hz.head(count - 1);
  const double low = steps.minCoeff(), high = steps.maxCoeff();
  if (high - low < 2e-3 * steps.mean()) {  // texts are rounded
    return fmt::format(", each {:.6g} Hz", steps.mean());
  }
  return fmt::format(", {:.4g} to {:.4g} Hz apart", low, high);
}

std::string place_of(const modal::MeasuredChannel& channel) {
  std::string words;
  if (channel.node) words += fmt::format("  node {}", *channel.node);
  if (channel.direction.any()) {
    words += fmt::format("  along ({:g}, {:g}, {:g})", channel.direction.x(), channel.direction.y(),
                         channel.direction.z());
  }
  if (channel.position) {
    const Eigen::Vector3d mm = 1e3 * *channel.position;
    words += fmt::format("  at ({:.1f}, {:.1f}, {:.1f}) mm", mm.x(), mm.y(), mm.z());
  }
  return words;
}

void show_channels(const char* side, const std::vector<modal::MeasuredChannel>& channels,
                   bool with_kind, std::ostream& results) {
  std::size_t widest = 9;
  const auto shown = std::span(channels).first(std::min(channels.size(), kMostChannelsShown));
  for (const auto& channel : shown) widest = std::max(widest, channel.name.size());
  results << fmt::format("\n  {:<{}}  unit\n", side, widest);
  for (const auto& channel : shown) {
    const std::string unit = channel.unit.empty() ? "not stated" : channel.unit;
    const char* kind = with_kind ? kKinds[static_cast<std::size_t>(channel.kind)] : "";
    const auto line =
        fmt::format("  {:<{}}  {:<10}  {}{}", channel.name, widest, unit, kind, place_of(channel));
    results << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
  }
  if (shown.size() < channels.size()) {
    results << fmt::format("  and {} more\n", channels.size() - shown.size());
  }
}

std::string coherence_text(double median) {
  return std::isnan(median) ? "-" : fmt::format("{:.4f}", median);
}

void show_responses(const modal::FrfSet& set, std::ostream& results) {
  const bool coherence = !set.coherence.empty();
  results << fmt::format("\n  {:<20}{:>12}{:>15}{}\n", "response", "largest", "at",
                         coherence ? "   median coherence" : "");
  Index shown = 0;
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      const auto found = largest(set, i, j);
      if (found.lines == 0 || ++shown > kMostShown) continue;
      const auto name = set.outputs[static_cast<std::size_t>(i)].name + "/" +
                        set.inputs[static_cast<std::size_t>(j)].name;
      results << fmt::format("  {:<20}{:>12.4g}{:>12.2f} Hz", name, found.size, found.frequency_hz)
              << (coherence ? fmt::format("{:>19}\n", coherence_text(found.coherence)) : "\n");
    }
  }
  if (shown > kMostShown) results << fmt::format("  and {} more\n", shown - kMostShown);
}

void show_notes(const std::vector<std::string>& notes, std::ostream& results) {
  results << (notes.empty() ? "\nnothing suspect\n" : "\nto be looked at\n");
  for (const auto& note : notes) results << "  - " << note << '\n';
}

io::JsonArray channels_json(const std::vector<modal::MeasuredChannel>& channels, bool with_kind) {
  io::JsonArray all;
  for (const auto& channel : channels) {
    io::JsonObject one{{"name", channel.name}, {"unit", channel.unit}};
    if (with_kind) one.emplace_back("kind", kKinds[static_cast<std::size_t>(channel.kind)]);
    if (channel.node) one.emplace_back("node", *channel.node);
    if (channel.direction.any()) one.emplace_back("direction", io::Json(channel.direction));
    if (channel.position) one.emplace_back("position_m", io::Json(*channel.position));
    all.emplace_back(std::move(one));
  }
  return all;
}

io::Json summary(const std::filesystem::path& path, const io::FrfFile& file) {
  const auto& set = file.set;
  const Index lines = set.line_count();
  return io::JsonObject{{"chladni", show::version()},
                        {"file", path.string()},
                        {"format", file.format},
                        {"holds", "frequency responses"},
                        {"lines", lines},
                        {"low_hz", set.frequency_hz(0)},
                        {"high_hz", set.frequency_hz(lines - 1)},
                        {"outputs", channels_json(set.outputs, true)},
                        {"inputs", channels_json(set.inputs, false)},
                        {"variance", !set.variance.empty()},
                        {"coherence", !set.coherence.empty()},
                        {"notes", io::Json::texts(file.notes)}};
}

void show(const std::filesystem::path& path, const io::FrfFile& file, std::ostream& results) {
  const auto& set = file.set;
  const Index lines = set.line_count();
  results << fmt::format("{}  {}: frequency responses of {} output{} to {} input{}\n",
                         path.filename().string(), file.format, set.output_count(),
                         set.output_count() == 1 ? "" : "s", set.input_count(),
                         set.input_count() == 1 ? "" : "s");
  results << fmt::format("{} lines, {:g} to {:g} Hz{}\n", lines, set.frequency_hz(0),
                         set.frequency_hz(lines - 1), resolution(set.frequency_hz));
  results << fmt::format("variance: {}   coherence: {}\n",
                         set.variance.empty()         ? "no"
                         : set.noise_variance.empty() ? "yes"
                                                      : "yes, and that of the noise alone",
                         set.coherence.empty() ? "no" : "yes");
  show_channels("output", set.outputs, true, results);
  show_channels("input", set.inputs, false, results);
  show_responses(set, results);
  show_notes(file.notes, results);
}

io::Json summary(const std::filesystem::path& path, const io::TimeFile& file) {
  const auto& data = file.data;
  return io::JsonObject{{"chladni", show::version()},
                        {"file", path.string()},
                        {"format", file.format},
                        {"holds", "recordings"},
                        {"records", static_cast<long>(data.records.size())},
                        {"samples", data.records.front().outputs.rows()},
                        {"sample_time_s", data.sample_time_s},
                        {"period", data.period},
                        {"outputs", channels_json(data.outputs, true)},
                        {"inputs", channels_json(data.inputs, false)},
                        {"references", channels_json(data.references, false)},
                        {"notes", io::Json::texts(file.notes)}};
}

void show(const std::filesystem::path& path, const io::TimeFile& file, std::ostream& results) {
  const auto& data = file.data;
  const Index samples = data.records.front().outputs.rows();
  results << fmt::format("{}  {}: {} recording{}, {} outputs, {} inputs, {} references\n",
                         path.filename().string(), file.format, data.records.size(),
                         data.records.size() == 1 ? "" : "s", data.outputs.size(),
                         data.inputs.size(), data.references.size());
  results << fmt::format("{} samples in the first, each {:g} s: {:g} s, up to {:g} Hz\n", samples,
                         data.sample_time_s, static_cast<double>(samples) * data.sample_time_s,
                         0.5 / data.sample_time_s);
  if (data.period > 0) {
    const double period_s = static_cast<double>(data.period) * data.sample_time_s;
    results << fmt::format("period: {} samples, {:g} s, lines each {:g} Hz\n", data.period,
                           period_s, 1.0 / period_s);
  }
  show_channels("output", data.outputs, true, results);
  show_channels("input", data.inputs, false, results);
  if (!data.references.empty()) show_channels("reference", data.references, false, results);
  show_notes(file.notes, results);
}

// "340 nodes, 676 elements, 2 trace lines"
std::string geometry_of(const io::NodeShapes& file) {
  std::string text = fmt::format("{} nodes with places", file.nodes);
  if (file.elements > 0) text += fmt::format(", {} elements", file.elements);
  if (file.trace_lines > 0) text += fmt::format(", {} trace lines", file.trace_lines);
  return text;
}

bool is_complex(const io::NodeShape& mode) {
  return std::ranges::any_of(mode.motion,
                             [](const auto& node) { return !node.second.imag().isZero(0.0); });
}

io::Json summary(const std::filesystem::path& path, const io::NodeShapes& file) {
  io::JsonArray modes;
  for (const auto& mode : file.modes) {
    modes.push_back(io::JsonObject{{"dataset", mode.dataset},
                                   {"frequency_hz", mode.frequency_hz},
                                   {"damping_ratio", mode.damping_ratio},
                                   {"nodes", static_cast<long>(mode.motion.size())},
                                   {"complex", is_complex(mode)}});
  }
  return io::JsonObject{{"chladni", show::version()},
                        {"file", path.string()},
                        {"format", "UFF"},
                        {"holds", "modes"},
                        {"modes", std::move(modes)},
                        {"nodes", file.nodes},
                        {"elements", file.elements},
                        {"trace_lines", file.trace_lines},
                        {"notes", io::Json::texts(file.notes)}};
}

void show(const std::filesystem::path& path, const io::NodeShapes& file, std::ostream& results) {
  results << fmt::format("{}  UFF: {} mode{}, {}\n\n", path.filename().string(), file.modes.size(),
                         file.modes.size() == 1 ? "" : "s", geometry_of(file));
  results << fmt::format("  {:>4}{:>14}{:>16}{:>8}{:>9}\n", "mode", "Hz", "damping ratio", "nodes",
                         "dataset");
  int number = 0;
  for (const auto& mode : file.modes) {
    results << fmt::format("  {:>4}{:>14.4f}{:>16.6f}{:>8}{:>9}{}\n", ++number, mode.frequency_hz,
                           mode.damping_ratio, mode.motion.size(), mode.dataset,
                           is_complex(mode) ? "  complex" : "");
  }
  show_notes(file.notes, results);
}

template <typename File>
int told(const std::filesystem::path& path, const File& file, const show::Options& options,
         std::ostream& results) {
  if (options.json) {
    results << io::text(summary(path, file));
  } else {
    show(path, file, results);
  }
  return 0;
}

}  // namespace

int check_data(const std::filesystem::path& file, const show::Options& options,
               std::ostream& results) {
  require(!options.expect,
          file.string() + ": --expect is of a study, and this is a file of measured data");
  require_one_unit(options.unit);
  try {
    io::FrfOptions frf;
    frf.unit = options.unit;
    return told(file, io::read_frf(file, frf), options, results);
  } catch (const io::NoResponses&) {
    if (io::is_universal_file(file)) {
      try {
        return told(file, io::read_node_shapes(file), options, results);
      } catch (const io::NoShapes&) {  // recordings, or nothing
      }
    }
    io::TimeOptions time;
    time.unit = options.unit;
    time.sample_time_s = options.sample_time_s;
    return told(file, io::read_time(file, time), options, results);
  }
}

}  // namespace chladni::app
