// Causes of channels with keys that are computed, and the tables of channels.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "steps/extend/extended_tables.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

std::string value_text(const Extension& by, const study::TomlNode& table, const std::string& key) {
  const auto* value = study::member(table, key);
  return value == nullptr ? std::string() : std::string(by.edit.written(*value));
}

template <Side side>
std::string sign(const Extension& by) {
  const auto found = only_channel(by, side);
  const auto* direction = study::member(found.table, "direction");
  std::string turned = direction_text(-found.channel.direction);
  if (direction != nullptr && direction->kind == study::TomlNode::Kind::text) {
    const auto& text = direction->text;
    turned = study::toml_text(
        text.starts_with('-') ? text.substr(1) : "-" + text.substr(text.starts_with('+') ? 1 : 0));
  }
  set_key(by, found, "direction", turned);
  return {};
}

template <Side side>
std::string tilt(const Extension& by) {
  const auto found = only_channel(by, side);
  const Eigen::Vector3d tilted = found.channel.direction + by.number("toward_u") * by.chart.axis_u +
                                 by.number("toward_v") * by.chart.axis_v;
  set_key(by, found, "direction", direction_text(tilted.normalized()));
  return {};
}

template <Side side>
std::string position(const Extension& by) {
  const auto found = only_channel(by, side);
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
  const auto a = channel_table(by, side, by.cause.channels[0]);
  const auto b = channel_table(by, side, by.cause.channels[1]);
  if (a.channel.node.has_value() != b.channel.node.has_value()) {
    return "one of the two channels has a node number and the other has none";
  }
  set_key(by, a, "name", study::toml_text(b.channel.name));
  set_key(by, b, "name", study::toml_text(a.channel.name));
  if (a.channel.node && b.channel.node) {
    set_key(by, a, "node", fmt::to_string(*b.channel.node));
    set_key(by, b, "node", fmt::to_string(*a.channel.node));
  }
  return {};
}

// A record keeps its label, so the channel that it is gets the record's name, and its node.
template <Side side>
std::string permute(const Extension& by) {
  const auto& cause = by.cause;
  require(cause.truly.size() == cause.channels.size(),
          fmt::format("the cause {} names {} records, but {} channels", cause.effect,
                      cause.channels.size(), cause.truly.size()));
  for (std::size_t i = 0; i < cause.channels.size(); ++i) {
    const auto record = channel_table(by, side, cause.channels[i]);
    const auto channel = channel_table(by, side, cause.truly[i]);
    if (record.channel.node.has_value() != channel.channel.node.has_value()) {
      return "one of the channels has a node number and another has none";
    }
    set_key(by, channel, "name", study::toml_text(record.channel.name));
    if (record.channel.node) set_key(by, channel, "node", fmt::to_string(*record.channel.node));
  }
  return {};
}

bool names(const diagnosis::Cause& cause, const std::string& channel) {
  return std::ranges::find(cause.channels, channel) != cause.channels.end();
}

// True if the cause is on all sensors of the fit.
bool of_all(const Extension& by) {
  if (!by.on.sensors.empty()) {
    return std::ranges::all_of(by.on.sensors,
                               [&](const std::string& sensor) { return names(by.cause, sensor); });
  }
  return std::ranges::all_of(by.study.sensors, [&](const study::Channel& sensor) {
    const auto held_out = by.study.measurement.value_or(study::MeasurementPlan{}).hold_out;
    return names(by.cause, sensor.name) ||
           std::ranges::find(held_out, sensor.name) != held_out.end();
  });
}

// Sensors of the cause. A cause on all sensors of the fit also applies to those held out and to
// those that were not measured.
std::vector<ChannelTable> sensors_of(const Extension& by) {
  if (of_all(by)) return all_sensors(by);
  std::vector<ChannelTable> some;
  for (const auto& name : by.cause.channels) some.push_back(channel_table(by, Side::sensors, name));
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
    set_key(by, found, "quantity", study::toml_text(kQuantities[static_cast<std::size_t>(kind)]));
  }
  return differentiate_unit(by, times);
}

std::string unit(const Extension& by) {
  for (const auto& found : sensors_of(by))
    set_key(by, found, "gain", digits(found.channel.gain * by.number("factor")));
  return {};
}

constexpr std::array<std::pair<std::string_view, Extend>, 12> kChannelEntries{
    {{"sensor_sign", sign<Side::sensors>},
     {"actuator_sign", sign<Side::actuators>},
     {"swapped_sensors", swap<Side::sensors>},
     {"swapped_actuators", swap<Side::actuators>},
     {"permuted_sensors", permute<Side::sensors>},
     {"permuted_actuators", permute<Side::actuators>},
     {"sensor_quantity", quantity},
     {"sensor_unit", unit},
     {"sensor_position", position<Side::sensors>},
     {"actuator_position", position<Side::actuators>},
     {"sensor_direction", tilt<Side::sensors>},
     {"actuator_direction", tilt<Side::actuators>}}};

}  // namespace

ChannelTable channel_table(const Extension& by, Side side, const std::string& name) {
  const auto& channels = side == Side::sensors ? by.study.sensors : by.study.actuators;
  const auto tables =
      study::tables_of(by.edit.tree(), side == Side::sensors ? "sensor" : "actuator");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == name) return {channels[i], *tables.at(i)};
  }
  throw InvalidInput(fmt::format("the cause {} is of \"{}\", which {} does not have",
                                 by.cause.effect, name, by.study.file.string()));
}

ChannelTable only_channel(const Extension& by, Side side) {
  require(by.cause.channels.size() == 1, fmt::format("the cause {} names {} channels, expected one",
                                                     by.cause.effect, by.cause.channels.size()));
  return channel_table(by, side, by.cause.channels.front());
}

std::vector<ChannelTable> all_sensors(const Extension& by) {
  std::vector<ChannelTable> all;
  for (const auto& sensor : by.study.sensors)
    all.push_back(channel_table(by, Side::sensors, sensor.name));
  return all;
}

void set_key(const Extension& by, const ChannelTable& of, const std::string& key,
             const std::string& value) {
  by.edit.set(of.table, "name", key, value, by.comment(value_text(by, of.table, key)));
}

Extend extend_channels(std::string_view effect) {
  for (const auto& [name, how] : kChannelEntries) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
