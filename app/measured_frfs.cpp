// The measurement's responses on the study's channels.
#include <fmt/format.h>

#include <algorithm>

#include "app/channel_paths.h"
#include "app/identification.h"
#include "app/study_parts.h"
#include "base/error.h"
#include "identification/closed_loop.h"
#include "identification/frf_estimate.h"
#include "identification/hammer.h"
#include "io/frf_file.h"
#include "io/time_file.h"

namespace chladni::app {
namespace {

const char* quantity_of(modal::FrfKind kind) {
  if (kind == modal::FrfKind::mobility) return "velocity";
  return kind == modal::FrfKind::accelerance ? "acceleration" : "displacement";
}

std::vector<std::pair<std::string, std::string>> named_pairs(const Study& study) {
  return study.identification ? study.identification->pairs
                              : std::vector<std::pair<std::string, std::string>>{};
}

modal::FrfSet read_responses(const Study& study, const std::filesystem::path& path, Run& run) {
  io::FrfOptions options;
  options.sensor_names = names_of(study.sensors);
  options.actuator_names = names_of(study.actuators);
  options.collocated = named_pairs(study);
  if (study.identification) options.unit = study.identification->unit;
  auto file = io::read_frf(path, options);
  for (const auto& note : file.notes) run.talk().note(path.string() + ": " + note);
  return std::move(file.set);
}

// Periodic recordings with references come from a loop, those without a period from a hammer.
modal::FrfSet responses_of(const identification::TimeData& data, std::vector<std::string>& notes) {
  if (data.period == 0) {
    auto hits = identification::hammer_estimate(data);
    notes = std::move(hits.notes);
    return std::move(hits.h1);
  }
  auto estimate = data.references.empty() ? identification::frf_estimate(data)
                                          : identification::closed_loop_estimate(data).estimate;
  notes = std::move(estimate.notes);
  return std::move(estimate.set);
}

modal::FrfSet estimated_responses(const Study& study, const std::filesystem::path& path, Run& run) {
  io::TimeOptions options;
  options.sensor_names = names_of(study.sensors);
  options.actuator_names = names_of(study.actuators);
  if (study.identification) options.unit = study.identification->unit;
  const auto file = io::read_time(path, options);
  for (const auto& note : file.notes) run.talk().note(path.string() + ": " + note);
  std::vector<std::string> notes;
  auto set = responses_of(file.data, notes);
  for (const auto& note : notes) run.talk().note(path.string() + ": " + note);
  return set;
}

// Rows (or columns) of the file that are channels of the study, in its order.
struct Matched {
  std::vector<Eigen::Index> of_file;
  std::vector<const Channel*> channel;
};

Matched matched(const std::vector<modal::MeasuredChannel>& measured,
                const std::vector<Channel>& channels, const std::string& file, Run& run) {
  Matched result;
  std::vector<bool> used(measured.size(), false);
  for (const auto& channel : channels) {
    const auto same = [&](const modal::MeasuredChannel& one) {
      return one.name == channel.name || (channel.node && one.node == channel.node);
    };
    const auto found = std::find_if(measured.begin(), measured.end(), same);
    if (found == measured.end()) {
      run.talk().note("\"" + channel.name + "\" was not measured: " + file +
                      " has no such channel");
      continue;
    }
    result.of_file.push_back(found - measured.begin());
    result.channel.push_back(&channel);
    used[static_cast<std::size_t>(found - measured.begin())] = true;
  }
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (used[i]) continue;
    run.talk().warn(file + ": \"" + measured[i].name +
                    "\" is no channel of the study; its responses are left out");
  }
  return result;
}

// Names, directions and places as the study has them.
void rename(modal::MeasuredChannel& one, const Channel& channel) {
  one.name = channel.name;
  one.direction = channel.direction;
  one.position = channel.at.point;
}

void set_kind(modal::MeasuredChannel& one, const Channel& channel, const std::string& file) {
  const auto kind = kind_of(channel.quantity);
  require(one.unit.empty() || one.kind == kind,
          fmt::format("{}: \"{}\" is measured in {}, {}, and the study says {}; correct the "
                      "channel's quantity",
                      file, channel.name, one.unit, quantity_of(one.kind), channel.quantity));
  one.kind = kind;
}

std::vector<Eigen::Index> seen(const std::vector<modal::MeasuredChannel>& channels,
                               const std::vector<std::string>& hold_out) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const bool hidden =
        std::find(hold_out.begin(), hold_out.end(), channels[i].name) != hold_out.end();
    if (!hidden) rows.push_back(static_cast<Eigen::Index>(i));
  }
  return rows;
}

}  // namespace

modal::FrfKind kind_of(const std::string& quantity) {
  if (quantity == "velocity") return modal::FrfKind::mobility;
  if (quantity == "acceleration") return modal::FrfKind::accelerance;
  return modal::FrfKind::receptance;
}

bool has_responses(const MeasurementPlan& plan) { return !plan.frf.empty() || !plan.time.empty(); }

MeasuredFrfs measured_frfs(const Study& study, Run& run) {
  require(study.measurement && has_responses(*study.measurement),
          study.file.string() +
              ": no responses are measured; expected [measurement] with frf = \"measured.uff\" or "
              "time = \"recorded.csv\"");
  const auto& plan = *study.measurement;
  const auto& path = plan.frf.empty() ? plan.time : plan.frf;
  auto set =
      plan.frf.empty() ? estimated_responses(study, path, run) : read_responses(study, path, run);
  const auto outputs = matched(set.outputs, study.sensors, path.string(), run);
  const auto inputs = matched(set.inputs, study.actuators, path.string(), run);
  require(!outputs.channel.empty() && !inputs.channel.empty(),
          path.string() + ": no response between a sensor and an actuator of the study; it has \"" +
              set.outputs.front().name + "\" by \"" + set.inputs.front().name + "\"");
  MeasuredFrfs result{path.string(), modal::part(set, outputs.of_file, inputs.of_file), {}, {}};
  for (std::size_t i = 0; i < outputs.channel.size(); ++i) {
    set_kind(result.all.outputs[i], *outputs.channel[i], result.file);
    rename(result.all.outputs[i], *outputs.channel[i]);
  }
  for (std::size_t j = 0; j < inputs.channel.size(); ++j) {
    rename(result.all.inputs[j], *inputs.channel[j]);
  }
  result.all = without_paths(study, std::move(result.all));
  result.outputs = seen(result.all.outputs, plan.hold_out);
  result.inputs = seen(result.all.inputs, plan.hold_out);
  require(!result.outputs.empty() && !result.inputs.empty(),
          study.file.string() + ": measurement.hold_out leaves no sensor or no actuator to a fit");
  return result;
}

}  // namespace chladni::app
