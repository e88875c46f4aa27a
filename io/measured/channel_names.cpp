#include "io/measured/channel_names.h"

#include <algorithm>

#include "base/error.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool knows(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Removes the separator at the start of "_u1" or "->u1".
std::string_view without_sign(std::string_view word) {
  const auto first = word.find_first_not_of("_-> .:|");
  return first == std::string_view::npos ? word : word.substr(first);
}

// Every way to divide the word so that both halves are known. Where one side has no list, any name
// is accepted for it.
std::vector<ChannelPair> known_cuts(std::string_view word, const std::vector<std::string>& sensors,
                                    const std::vector<std::string>& actuators) {
  std::vector<ChannelPair> cuts;
  for (std::size_t at = 1; at < word.size(); ++at) {
    const auto sensor = word.substr(0, at);
    const auto rest = word.substr(at);
    if (!sensors.empty() && !knows(sensors, sensor)) continue;
    if (sensors.empty() && !knows(actuators, rest)) continue;
    const auto actuator = knows(actuators, rest) ? rest : without_sign(rest);
    if (!actuators.empty() && !knows(actuators, actuator)) continue;
    cuts.emplace_back(sensor, actuator);
  }
  return cuts;
}

// The end of a name from `from` on: letters (anything but digits), then digits. npos where either
// is missing.
std::size_t end_of_name(std::string_view word, std::size_t from) {
  std::size_t at = from;
  while (at < word.size() && !is_digit(word[at])) ++at;
  if (at == from || at == word.size()) return std::string_view::npos;
  while (at < word.size() && is_digit(word[at])) ++at;
  return at;
}

std::optional<ChannelPair> pattern_cut(std::string_view word) {
  const auto middle = end_of_name(word, 0);
  if (middle >= word.size()) return std::nullopt;
  const auto actuator = without_sign(word.substr(middle));
  if (end_of_name(actuator, 0) != actuator.size()) return std::nullopt;
  return ChannelPair(word.substr(0, middle), actuator);
}

}  // namespace

ChannelPair channel_pair(std::string_view word, const std::vector<std::string>& sensors,
                         const std::vector<std::string>& actuators) {
  const auto stroke = word.find('/');
  if (stroke != std::string_view::npos) {
    const auto sensor = trimmed(word.substr(0, stroke));
    const auto actuator = trimmed(word.substr(stroke + 1));
    require(!sensor.empty() && !actuator.empty() && actuator.find('/') == std::string_view::npos,
            "found " + shown(word) + ", expected sensor/actuator with one stroke");
    return {std::string(sensor), std::string(actuator)};
  }
  if (!sensors.empty() || !actuators.empty()) {
    const auto cuts = known_cuts(word, sensors, actuators);
    if (cuts.size() == 1) return cuts.front();
    if (cuts.size() > 1) {
      throw InvalidInput(shown(word) + " is " + shown(cuts[0].first) + " with " +
                         shown(cuts[0].second) + " or " + shown(cuts[1].first) + " with " +
                         shown(cuts[1].second) + "; write a / between sensor and actuator");
    }
  }
  if (auto cut = pattern_cut(word)) return *cut;
  throw InvalidInput("cannot tell where the sensor's name ends in " + shown(word) +
                     "; expected names such as y1u1, names of known channels, or a / between "
                     "sensor and actuator");
}

}  // namespace chladni::io
