// Causes whose record says how a study writes them (diagnosis/in_study.h).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"
#include "diagnosis/effect.h"
#include "steps/extend/extended_tables.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

using diagnosis::InStudy;
using diagnosis::StudyKey;

double changed(double before, double number, StudyKey::How how) {
  switch (how) {
    case StudyKey::How::times:
      return before * number;
    case StudyKey::How::times_one_plus:
      return before * (1.0 + number);
    case StudyKey::How::plus:
      return before + number;
    case StudyKey::How::plus_lag:  // two lags in series are one with their sum, to first order
      return 1.0 / ((before > 0.0 ? 1.0 / before : 0.0) + 1.0 / number);
    case StudyKey::How::set:
    case StudyKey::How::computed:
      break;
  }
  return number;
}

// The keys of a new table. Numbers that the cause lacks are left out.
void add_keys(const Extension& by, const InStudy& record, Members& members) {
  for (const auto& key : record.keys) {
    if (!by.has(key.number)) continue;
    members.emplace_back(std::string(key.key), written(by.number(key.number), key.unit));
  }
}

std::string attach(const Extension& by, const InStudy& record) {
  Members members;
  if (record.along_normal) members.emplace_back("direction", normal(by));
  add_keys(by, record, members);
  append_attachment(by, place(by), std::string(record.kind), std::string(record.kind), members);
  return {};
}

// On the channels that the diagnosis had: on others it knows of no mass.
std::string attach_to(const Extension& by, const InStudy& record,
                      const std::vector<study::Channel>& channels,
                      const std::vector<std::string>& seen) {
  Members members;
  add_keys(by, record, members);
  for (const auto& channel : channels) {
    if (!seen.empty() && std::ranges::find(seen, channel.name) == seen.end()) continue;
    append_attachment(by, place(channel.at), std::string(record.kind),
                      std::string(record.kind) + "_of_" + channel.name, members);
  }
  return {};
}

std::string vary(const Extension& by, const InStudy& record) {
  if (!by.fits_variations) return kOtherChart;
  Members members{{"of", study::toml_text(std::string(record.kind))}};
  if (record.at_place) members.emplace_back("at", place(by));
  add_keys(by, record, members);
  by.edit.append("variation", members, by.comment());
  return {};
}

void scale_keys(const Extension& by, const InStudy& record, const study::TomlNode& table) {
  for (const auto& key : record.keys) {
    const auto* value = study::member(table, key.key);
    if (value != nullptr) scale(by, *value, changed(1.0, by.number(key.number), key.how));
  }
}

std::string scale_materials(const Extension& by, const InStudy& record) {
  for (const auto* table : study::tables_of(by.edit.tree(), "material")) {
    scale_keys(by, record, *table);
  }
  return {};
}

std::string scale_modes(const Extension& by, const InStudy& record) {
  const auto* modes = study::member(by.edit.tree(), "modes");
  const bool has_all = modes != nullptr && std::ranges::all_of(record.keys, [&](const auto& key) {
                         return study::member(*modes, key.key) != nullptr;
                       });
  if (!has_all || by.study.modes.damping_ratio == 0.0) {
    return "the study says no damping ratio that could be multiplied";
  }
  scale_keys(by, record, *modes);
  return {};
}

constexpr std::array<std::pair<std::string_view, double study::Channel::*>, 3> kPath{
    {{"gain", &study::Channel::gain},
     {"delay", &study::Channel::delay},
     {"low_pass", &study::Channel::low_pass_hz}}};

std::string change(const Extension& by, const InStudy& record,
                   const std::vector<ChannelTable>& channels) {
  for (const auto& channel : channels) {
    for (const auto& key : record.keys) {
      const auto* path = std::ranges::find(kPath, key.key, &decltype(kPath)::value_type::first);
      require(path != kPath.end(), fmt::format("a channel has no number \"{}\"", key.key));
      const double after = changed(channel.channel.*(path->second), by.number(key.number), key.how);
      set_key(by, channel, std::string(key.key), written(after, key.unit));
    }
  }
  return {};
}

}  // namespace

std::string extend_by_record(const Extension& by) {
  using Table = InStudy::Table;
  const InStudy& record = diagnosis::effect(by.cause.effect).in_study;
  if (record.is_positive && !(by.number(record.keys.begin()->number) > 0.0)) return kNoNegativeMass;
  switch (record.table) {
    case Table::attachment:
      return attach(by, record);
    case Table::sensor_attachments:
      return attach_to(by, record, by.study.sensors, by.on.sensors);
    case Table::actuator_attachments:
      return attach_to(by, record, by.study.actuators, by.on.actuators);
    case Table::variation:
      return vary(by, record);
    case Table::materials:
      return scale_materials(by, record);
    case Table::modes:
      return scale_modes(by, record);
    case Table::sensors:
      return change(by, record, {only_channel(by, Side::sensors)});
    case Table::actuators:
      return change(by, record, {only_channel(by, Side::actuators)});
    case Table::all_sensors:
      return change(by, record, all_sensors(by));
    case Table::none:
    case Table::geometry:  // the shape of the body decides which keys: extension_body.cpp
      break;
  }
  return record.refusal.empty() ? "a study has no key for it" : std::string(record.refusal);
}

}  // namespace chladni::steps
