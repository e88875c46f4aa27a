// Causes on the path between a channel and its record.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

enum class Side { sensors, actuators };

/// A channel of the study and its table in the document.
struct Found {
  const study::Channel& channel;
  const study::TomlNode& table;
};

Found find(const Extension& by, Side side, const std::string& name) {
  const auto& channels = side == Side::sensors ? by.study.sensors : by.study.actuators;
  const auto tables =
      study::tables_of(by.edit.tree(), side == Side::sensors ? "sensor" : "actuator");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == name) return {channels[i], *tables.at(i)};
  }
  throw InvalidInput(fmt::format("the cause {} is of \"{}\", which {} does not have",
                                 by.cause.effect, name, by.study.file.string()));
}

Found only(const Extension& by, Side side) {
  require(by.cause.channels.size() == 1, fmt::format("the cause {} names {} channels, expected one",
                                                     by.cause.effect, by.cause.channels.size()));
  return find(by, side, by.cause.channels.front());
}

std::vector<Found> all_sensors(const Extension& by) {
  std::vector<Found> all;
  for (const auto& sensor : by.study.sensors) all.push_back(find(by, Side::sensors, sensor.name));
  return all;
}

std::string written(const Extension& by, const study::TomlNode& table, const char* key) {
  const auto* value = study::member(table, key);
  return value == nullptr ? std::string() : std::string(by.edit.written(*value));
}

void set(const Extension& by, const Found& of, const char* key, const std::string& value) {
  by.edit.set(of.table, "name", key, value, by.comment(written(by, of.table, key)));
}

void multiply_gain(const Extension& by, const Found& of, double factor) {
  set(by, of, "gain", digits(of.channel.gain * factor));
}
void delay_by(const Extension& by, const Found& of) {
  set(by, of, "delay",
      study::toml_text(digits(1e6 * (of.channel.delay + by.number("delay"))) + " us"));
}
// Two lags in series are one with their sum, to first order.
void filter_by(const Extension& by, const Found& of) {
  const double before = of.channel.low_pass_hz > 0.0 ? 1.0 / of.channel.low_pass_hz : 0.0;
  set(by, of, "low_pass",
      study::toml_text(digits(1.0 / (before + 1.0 / by.number("frequency"))) + " Hz"));
}

template <Side side>
std::string gain(const Extension& by) {
  multiply_gain(by, only(by, side), 1.0 + by.number("relative"));
  return {};
}
std::string overall_gain(const Extension& by) {
  for (const auto& one : all_sensors(by)) multiply_gain(by, one, 1.0 + by.number("relative"));
  return {};
}
template <Side side>
std::string delay(const Extension& by) {
  delay_by(by, only(by, side));
  return {};
}
std::string overall_delay(const Extension& by) {
  for (const auto& one : all_sensors(by)) delay_by(by, one);
  return {};
}
template <Side side>
std::string low_pass(const Extension& by) {
  filter_by(by, only(by, side));
  return {};
}
std::string overall_low_pass(const Extension& by) {
  for (const auto& one : all_sensors(by)) filter_by(by, one);
  return {};
}

std::string vector(const Eigen::Vector3d& v) {
  const auto shown = [](double x) { return digits(std::abs(x) < 1e-12 ? 0.0 : x); };
  return fmt::format("[{}, {}, {}]", shown(v(0)), shown(v(1)), shown(v(2)));
}

template <Side side>
std::string sign(const Extension& by) {
  const auto found = only(by, side);
  const auto* direction = study::member(found.table, "direction");
  std::string turned = vector(-found.channel.direction);
  if (direction != nullptr && direction->kind == study::TomlNode::Kind::text) {
    const auto& text = direction->text;
    turned = study::toml_text(
        text.starts_with('-') ? text.substr(1) : "-" + text.substr(text.starts_with('+') ? 1 : 0));
  }
  set(by, found, "direction", turned);
  return {};
}

template <Side side>
std::string tilt(const Extension& by) {
  const auto found = only(by, side);
  const Eigen::Vector3d tilted = found.channel.direction + by.number("toward_u") * by.chart.axis_u +
                                 by.number("toward_v") * by.chart.axis_v;
  set(by, found, "direction", vector(tilted.normalized()));
  return {};
}

template <Side side>
std::string position(const Extension& by) {
  const auto found = only(by, side);
  const double v = by.has("v") ? by.number("v") : 0.0;
  const Eigen::Vector3d step = by.number("u") * by.chart.axis_u + v * by.chart.axis_v;
  const auto* at = study::member(found.table, "at");
  const auto count = static_cast<Eigen::Index>(at->elements.size());
  if (count == 2 && step(2) != 0.0) {
    return "the channel's place is seen from above and the body stands upright";
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    if (step(k) != 0.0) lengthen(by, at->elements[static_cast<std::size_t>(k)], step(k));
  }
  return {};
}

// Exchanges labels: a label belongs to the record, so the channel at the first place gets the other
// name.
template <Side side>
std::string swap(const Extension& by) {
  require(by.cause.channels.size() == 2, fmt::format("the cause {} names {} channels, expected two",
                                                     by.cause.effect, by.cause.channels.size()));
  const auto a = find(by, side, by.cause.channels[0]);
  const auto b = find(by, side, by.cause.channels[1]);
  if (a.channel.node.has_value() != b.channel.node.has_value()) {
    return "one of the two channels has a node number and the other has none";
  }
  set(by, a, "name", study::toml_text(b.channel.name));
  set(by, b, "name", study::toml_text(a.channel.name));
  if (a.channel.node && b.channel.node) {
    set(by, a, "node", std::to_string(*b.channel.node));
    set(by, b, "node", std::to_string(*a.channel.node));
  }
  return {};
}

bool names(const diagnosis::Cause& cause, const std::string& channel) {
  return std::ranges::find(cause.channels, channel) != cause.channels.end();
}

// True if the cause is on all sensors of the fit.
bool of_all(const Extension& by) {
  return std::ranges::all_of(by.study.sensors, [&](const study::Channel& sensor) {
    const auto held_out = by.study.measurement.value_or(study::MeasurementPlan{}).hold_out;
    return names(by.cause, sensor.name) ||
           std::ranges::find(held_out, sensor.name) != held_out.end();
  });
}

// Sensors of the cause. A cause on all sensors of the fit also applies to those held out.
std::vector<Found> sensors_of(const Extension& by) {
  if (of_all(by)) return all_sensors(by);
  std::vector<Found> some;
  for (const auto& name : by.cause.channels) some.push_back(find(by, Side::sensors, name));
  return some;
}

// The unit of a derivative: "mm" differentiated twice is "mm/s^2", "mm/N" is "mm/s^2/N". Empty if
// it has no name, as for "g" integrated once.
std::string differentiated(std::string unit, long times) {
  constexpr std::array<std::string_view, 3> kPer{"", "/s", "/s^2"};
  const auto is_of_time = [](const std::string& part) { return part == "/s" || part == "/s^2"; };
  std::string per_force;
  if (const auto stroke = unit.rfind('/'); stroke != std::string::npos) {
    if (!is_of_time(unit.substr(stroke))) {
      per_force = unit.substr(stroke);
      unit.resize(stroke);
    }
  }
  long has = 0;
  for (long k = 1; k < 3; ++k) {
    if (unit.ends_with(kPer[static_cast<std::size_t>(k)])) has = k;
  }
  const long wanted = has + times;
  if (wanted < 0 || wanted > 2) return "";
  unit.resize(unit.size() - kPer[static_cast<std::size_t>(has)].size());
  return unit + std::string(kPer[static_cast<std::size_t>(wanted)]) + per_force;
}

// `[identification] unit` applies to all sensors and to one quantity.
std::string differentiate_unit(const Extension& by, long times) {
  const auto* table = study::member(by.edit.tree(), "identification");
  const auto* unit = table == nullptr ? nullptr : study::member(*table, "unit");
  if (unit == nullptr || unit->text.empty()) return {};
  if (!of_all(by)) {
    return "identification.unit is that of all sensors: state each sensor's unit in the file of "
           "the responses";
  }
  const auto other = differentiated(unit->text, times);
  if (other.empty()) return "a response in " + unit->text + " has no such unit";
  by.edit.replace(*unit, study::toml_text(other), by.comment(by.edit.written(*unit)));
  return {};
}

std::string quantity(const Extension& by) {
  constexpr std::array<const char*, 3> kQuantities{"displacement", "velocity", "acceleration"};
  const long times = std::lround(by.number("derivative"));
  for (const auto& found : sensors_of(by)) {
    long kind = times;
    for (std::size_t k = 0; k < 3; ++k) {
      if (found.channel.quantity == kQuantities[k]) kind += static_cast<long>(k);
    }
    if (kind < 0 || kind > 2) return "a sensor measures displacement, velocity or acceleration";
    set(by, found, "quantity", study::toml_text(kQuantities[static_cast<std::size_t>(kind)]));
  }
  return differentiate_unit(by, times);
}

std::string unit(const Extension& by) {
  for (const auto& found : sensors_of(by)) multiply_gain(by, found, by.number("factor"));
  return {};
}

std::string crosstalk(const Extension& /*by*/) {
  return "it is in the records: take the share of the other channel off them";
}

constexpr std::array<std::pair<std::string_view, Extend>, 21> kTable{
    {{"sensor_sign", sign<Side::sensors>},
     {"actuator_sign", sign<Side::actuators>},
     {"swapped_sensors", swap<Side::sensors>},
     {"swapped_actuators", swap<Side::actuators>},
     {"sensor_quantity", quantity},
     {"sensor_unit", unit},
     {"sensor_gain", gain<Side::sensors>},
     {"actuator_gain", gain<Side::actuators>},
     {"overall_gain", overall_gain},
     {"sensor_position", position<Side::sensors>},
     {"actuator_position", position<Side::actuators>},
     {"sensor_direction", tilt<Side::sensors>},
     {"actuator_direction", tilt<Side::actuators>},
     {"sensor_crosstalk", crosstalk},
     {"actuator_crosstalk", crosstalk},
     {"delay", overall_delay},
     {"sensor_delay", delay<Side::sensors>},
     {"actuator_delay", delay<Side::actuators>},
     {"low_pass", overall_low_pass},
     {"sensor_low_pass", low_pass<Side::sensors>},
     {"actuator_low_pass", low_pass<Side::actuators>}}};

}  // namespace

Extend extend_channels(std::string_view effect) {
  for (const auto& [name, how] : kTable) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
