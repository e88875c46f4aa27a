#include "steps/measured/measured_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/frf_file.h"
#include "io/scan.h"
#include "steps/identification.h"

namespace chladni::steps {
namespace {

using Index = Eigen::Index;
using modal::MeasuredChannel;

enum class Along { same, opposite, across, oblique, not_stated };

Along compared(const Eigen::Vector3d& stated, const Eigen::Vector3d& wanted) {
  if (!stated.any()) return Along::not_stated;
  const double along = stated.dot(wanted);
  if (stated.cross(wanted).norm() <= kObliqueChannel)
    return along > 0.0 ? Along::same : Along::opposite;
  return std::abs(along) <= kObliqueChannel ? Along::across : Along::oblique;
}

bool is_parallel(Along along) { return along == Along::same || along == Along::opposite; }

std::string text_of(const Eigen::Vector3d& direction) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", direction.x() + 0.0, direction.y() + 0.0,
                     direction.z() + 0.0);
}

std::string text_of(const MeasuredChannel& one) {
  std::string text = "\"" + one.name + "\"";
  if (one.node) text += fmt::format(" (node {}, ", *one.node);
  if (!one.node) text += " (";
  return text + (one.direction.any() ? "along " + text_of(one.direction) : "without a direction") +
         ")";
}

class Matching {
 public:
  Matching(const std::vector<MeasuredChannel>& measured, const std::string& file, stage::Work& work)
      : measured_(measured), file_(file), work_(work) {}

  std::optional<MatchedChannel> match(const study::Channel& channel) const {
    const auto by_name =
        chosen([&](const MeasuredChannel& one) { return one.name == channel.name; });
    const auto at_node = chosen(
        [&](const MeasuredChannel& one) { return channel.node && one.node == channel.node; });
    if (!by_name.empty()) return named(channel, by_name.front(), at_node);
    return at_the_node(channel, at_node);
  }

 private:
  template <typename Wanted>
  [[nodiscard]] std::vector<Index> chosen(const Wanted& wanted) const {
    std::vector<Index> result;
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      if (wanted(measured_[i])) result.push_back(static_cast<Index>(i));
    }
    return result;
  }

  [[nodiscard]] const MeasuredChannel& at(Index i) const {
    return measured_[static_cast<std::size_t>(i)];
  }

  [[nodiscard]] std::string listed(const std::vector<Index>& candidates) const {
    std::string text;
    for (const auto i : candidates) text += (text.empty() ? "" : ", ") + text_of(at(i));
    return text;
  }

  [[noreturn]] void refuse(const study::Channel& channel, const std::string& found,
                           const std::vector<Index>& candidates) const {
    throw InvalidInput(
        fmt::format("{}: \"{}\" along {}: {}: {}; expected one along its axis, or a "
                    "channel of that name",
                    file_, channel.name, text_of(channel.direction), found, listed(candidates)));
  }

  [[nodiscard]] MatchedChannel named(const study::Channel& channel, Index i,
                                     const std::vector<Index>& at_node) const {
    for (const auto other : at_node) {
      if (other == i || !is_parallel(compared(at(other).direction, channel.direction))) continue;
      refuse(channel, "one channel fits by its name and another by its node", {i, other});
    }
    const auto along = compared(at(i).direction, channel.direction);
    require(is_parallel(along) || along == Along::not_stated,
            fmt::format("{}: {} is along {} in the study; correct the study's direction, or call "
                        "the channel by another name",
                        file_, text_of(at(i)), text_of(channel.direction)));
    return {&channel, i, along == Along::opposite};
  }

  [[nodiscard]] std::optional<MatchedChannel> at_the_node(
      const study::Channel& channel, const std::vector<Index>& candidates) const {
    const auto part = [&](auto wanted) {
      std::vector<Index> result;
      for (const auto i : candidates) {
        if (wanted(compared(at(i).direction, channel.direction))) result.push_back(i);
      }
      return result;
    };
    const auto parallel = part(is_parallel);
    if (parallel.size() == 1) {
      const auto i = parallel.front();
      return MatchedChannel{&channel, i,
                            compared(at(i).direction, channel.direction) == Along::opposite};
    }
    const std::string place = fmt::format(" of node {}", channel.node.value_or(0));
    if (parallel.size() > 1) refuse(channel, "two channels" + place + " fit it", parallel);
    if (part([](Along along) { return along != Along::across; }).empty()) {
      note_missing(channel, candidates);
      return std::nullopt;
    }
    refuse(channel, "no channel" + place + " is along it for certain", candidates);
  }

  void note_missing(const study::Channel& channel, const std::vector<Index>& candidates) const {
    std::string what = "\"" + channel.name + "\" was not measured: " + file_ + " has ";
    if (candidates.empty()) {
      what += "no such channel";
    } else {
      what += fmt::format("at node {} only {}", channel.node.value_or(0), listed(candidates));
    }
    work_.note(what);
  }

  const std::vector<MeasuredChannel>& measured_;
  const std::string& file_;
  stage::Work& work_;
};

}  // namespace

std::vector<MatchedChannel> matched_channels(const std::vector<MeasuredChannel>& measured,
                                             const std::vector<study::Channel>& channels,
                                             const std::string& file, stage::Work& work) {
  const Matching matching(measured, file, work);
  std::vector<MatchedChannel> result;
  std::vector<const study::Channel*> user(measured.size(), nullptr);
  for (const auto& channel : channels) {
    const auto found = matching.match(channel);
    if (!found) continue;
    const auto& one = measured[static_cast<std::size_t>(found->of_file)];
    auto& before = user[static_cast<std::size_t>(found->of_file)];
    require(before == nullptr,
            fmt::format("{}: {} is both \"{}\" and \"{}\" of the study; expected one of them", file,
                        text_of(one), before == nullptr ? "" : before->name, channel.name));
    before = &channel;
    result.push_back(*found);
    if (!found->turned) continue;
    work.note(fmt::format("{}: {} is \"{}\" against its direction: its sign is turned", file,
                          text_of(one), channel.name));
  }
  std::vector<std::string> others;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (user[i] == nullptr) others.push_back("\"" + measured[i].name + "\"");
  }
  if (others.empty()) return result;
  work.warn(file + ": " + io::listed(others) +
            (others.size() == 1 ? " is no channel" : " are no channels") + " of the study; " +
            (others.size() == 1 ? "its" : "their") + " responses are left out");
  return result;
}

namespace {

const char* quantity_of(modal::FrfKind kind) {
  if (kind == modal::FrfKind::mobility) return "velocity";
  return kind == modal::FrfKind::accelerance ? "acceleration" : "displacement";
}

const char* si_unit_of(modal::FrfKind kind) {
  constexpr const char* units[] = {"m", "m/s", "m/s^2"};
  return units[static_cast<std::size_t>(kind)];
}

// Whether it is a unit of any motion, in SI.
bool is_of_motion(const std::string& unit) {
  using enum modal::FrfKind;
  return unit == si_unit_of(receptance) || unit == si_unit_of(mobility) ||
         unit == si_unit_of(accelerance);
}

// Units by which a study may say what a file does not.
const char* examples_of(modal::FrfKind kind) {
  if (kind == modal::FrfKind::mobility) return "\"m/s\" or \"mm/s\"";
  return kind == modal::FrfKind::accelerance ? "\"m/s^2\" or \"g\"" : "\"m\" or \"um\"";
}

}  // namespace

void set_kind(modal::MeasuredChannel& one, const study::Channel& channel, const std::string& file,
              bool each_in_si) {
  const auto kind = kind_of(channel.quantity);
  const bool is_stated = !one.unit.empty() || kind == modal::FrfKind::receptance || each_in_si;
  require(is_stated,
          fmt::format("{}: \"{}\" measures {}, and no unit is stated; say that of the responses "
                      "as [identification] unit = {}, or as \"{}\" where sensors differ",
                      file, channel.name, channel.quantity, examples_of(kind), io::kEachInSi));
  // A file may state the kind without a unit: by the type of its data, or by a label.
  require(!one.unit.empty() || one.kind == kind || one.kind == modal::FrfKind::receptance,
          fmt::format(
              "{}: \"{}\" is of {} as the file says, without a unit, and the study says {}; "
              "correct the channel's quantity, and say the unit as [identification] unit = "
              "{}",
              file, channel.name, quantity_of(one.kind), channel.quantity, examples_of(one.kind)));
  require(
      one.unit.empty() || is_of_motion(one.unit),
      fmt::format("{}: \"{}\" is measured in \"{}\", and the study says {}; expected {}. Correct "
                  "[identification] unit, or the unit in the file (`chladni convert` to .csv "
                  "leaves it out)",
                  file, channel.name, one.unit, channel.quantity, examples_of(kind)));
  require(one.unit.empty() || one.kind == kind,
          fmt::format("{}: \"{}\" is measured in {}, {}, and the study says {}; correct the "
                      "channel's quantity",
                      file, channel.name, one.unit, quantity_of(one.kind), channel.quantity));
  one.kind = kind;
  if (one.unit.empty() && each_in_si) one.unit = si_unit_of(kind);
}

}  // namespace chladni::steps
