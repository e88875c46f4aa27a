// The measurement's responses on the study's channels.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "io/frf_file.h"
#include "modal/stated_variances.h"
#include "stage/channel_paths.h"
#include "steps/identification.h"
#include "steps/measured/measured_channels.h"
#include "steps/measured/recorded_frfs.h"

namespace chladni::steps {
namespace {

std::vector<std::pair<std::string, std::string>> named_pairs(const study::Study& study) {
  return study.identification ? study.identification->pairs
                              : std::vector<std::pair<std::string, std::string>>{};
}

modal::FrfSet read_responses(const study::Study& study, const std::filesystem::path& path,
                             stage::Work& work) {
  io::FrfOptions options;
  options.sensor_names = study::names_of(study.sensors);
  options.actuator_names = study::names_of(study.actuators);
  options.collocated = named_pairs(study);
  if (study.identification) options.unit = study.identification->unit;
  auto file = io::read_frf(path, options);
  for (const auto& note : file.notes) work.note(path.string() + ": " + note);
  return std::move(file.set);
}

std::vector<Eigen::Index> places_of(const std::vector<MatchedChannel>& matched) {
  std::vector<Eigen::Index> places;
  for (const auto& one : matched) places.push_back(one.of_file);
  return places;
}

// The matched part of the set, with the study's directions.
modal::FrfSet part_of(const modal::FrfSet& set, const std::vector<MatchedChannel>& outputs,
                      const std::vector<MatchedChannel>& inputs) {
  auto part = modal::part(set, places_of(outputs), places_of(inputs));
  for (auto& line : part.value) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (outputs[i].turned) line.row(static_cast<Eigen::Index>(i)) *= -1.0;
    }
    for (std::size_t j = 0; j < inputs.size(); ++j) {
      if (inputs[j].turned) line.col(static_cast<Eigen::Index>(j)) *= -1.0;
    }
  }
  return part;
}

// Takes names, directions and places from the study; the signs are already turned.
void rename(modal::MeasuredChannel& one, const study::Channel& channel) {
  one.name = channel.name;
  one.direction = channel.direction;
  one.position = channel.at.point;
}

// The study's actuators are forces.
void warn_of_other_inputs(const std::vector<modal::MeasuredChannel>& of_file,
                          const std::vector<MatchedChannel>& matched, const std::string& file,
                          stage::Work& work) {
  for (const auto& one : matched) {
    const auto& unit = of_file[static_cast<std::size_t>(one.of_file)].unit;
    if (unit.empty() || unit == "N") continue;
    work.warn(file + ": the input of \"" + one.channel->name + "\" is in " + unit +
              ", and an actuator of a study is a force: its responses are taken as if each " +
              unit + " were 1 N. Say how many newtons it is as the actuator's gain");
  }
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

bool has_responses(const study::MeasurementPlan& plan) {
  return !plan.frf.empty() || !plan.time.empty();
}

namespace {

// The channels of the study in a file.
struct Matched {
  std::vector<MatchedChannel> outputs, inputs;
};

// The set on the study's channels, without their gains and delays.
modal::FrfSet on_channels(const study::Study& study, const modal::FrfSet& set,
                          const Matched& matched, const std::string& file) {
  const bool each_in_si = study.identification && study.identification->unit == io::kEachInSi;
  auto result = part_of(set, matched.outputs, matched.inputs);
  for (std::size_t i = 0; i < matched.outputs.size(); ++i) {
    set_kind(result.outputs[i], *matched.outputs[i].channel, file, each_in_si);
    rename(result.outputs[i], *matched.outputs[i].channel);
  }
  for (std::size_t j = 0; j < matched.inputs.size(); ++j) {
    rename(result.inputs[j], *matched.inputs[j].channel);
  }
  return stage::without_paths(study, std::move(result));
}

}  // namespace

MeasuredFrfs measured_frfs(const study::Study& study, stage::Work& work, bool with_folds) {
  require(study.measurement && has_responses(*study.measurement),
          study.file.string() +
              ": no responses are measured; expected [measurement] with frf = \"measured.uff\" or "
              "time = \"recorded.csv\"");
  const auto& plan = *study.measurement;
  const auto& path = plan.frf.empty() ? plan.time : plan.frf;
  require(std::filesystem::exists(path),
          path.string() + ": there is no such file" + study::source_text(plan));
  RecordedFrfs recorded;
  if (plan.frf.empty()) {
    recorded = recorded_frfs(study, work, with_folds);
  } else {
    recorded.set = read_responses(study, path, work);
  }
  const auto& set = recorded.set;
  const Matched matched{matched_channels(set.outputs, study.sensors, path.string(), work),
                        matched_channels(set.inputs, study.actuators, path.string(), work)};
  require(!matched.outputs.empty() && !matched.inputs.empty(),
          path.string() + ": no response between a sensor and an actuator of the study; it has \"" +
              set.outputs.front().name + "\" by \"" + set.inputs.front().name + "\"");
  warn_of_other_inputs(set.inputs, matched.inputs, path.string(), work);
  MeasuredFrfs result;
  result.file = path.string();
  result.all = on_channels(study, set, matched, result.file);
  if (!modal::states_variances(result.all)) result.all.variance.clear();  // zeros state none
  result.quality = std::move(recorded.quality);
  result.added_decay = recorded.added_decay;
  result.folds = std::move(recorded.folds);
  for (auto& fold : result.folds.folds) {
    fold.rest = on_channels(study, fold.rest, matched, result.file);
    fold.left_out = on_channels(study, fold.left_out, matched, result.file);
  }
  result.outputs = seen(result.all.outputs, plan.hold_out);
  result.inputs = seen(result.all.inputs, plan.hold_out);
  require(!result.outputs.empty() && !result.inputs.empty(),
          study.file.string() + ": measurement.hold_out leaves no sensor or no actuator to a fit");
  return result;
}

}  // namespace chladni::steps
