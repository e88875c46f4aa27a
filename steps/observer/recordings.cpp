// The recordings over which an observer runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/frf_file.h"
#include "stage/channel_paths.h"
#include "steps/measured/measured_channels.h"
#include "steps/measured/recorded_frfs.h"
#include "steps/observer.h"

namespace chladni::steps {
namespace {

// A column of a record, with the sign that the study gives it.
struct Column {
  Eigen::Index of_file = 0;
  double sign = 1.0;
};

std::filesystem::path file_of(const study::Study& study) {
  if (study.observer && !study.observer->replay.empty()) return study.observer->replay;
  return study.measurement ? study.measurement->time : std::filesystem::path{};
}

Column column(const std::vector<MatchedChannel>& matched, const std::string& name,
              const std::string& file) {
  const auto found =
      std::ranges::find_if(matched, [&](const auto& one) { return one.channel->name == name; });
  require(found != matched.end(),
          file + ": \"" + name + "\" is not in it; expected every sensor and actuator of the fit");
  return {found->of_file, found->turned ? -1.0 : 1.0};
}

// A held-out sensor of displacement judges the estimate.
bool is_judge(const study::Study& study, const MatchedChannel& one) {
  const auto& hold_out = study.measurement->hold_out;
  return std::ranges::find(hold_out, one.channel->name) != hold_out.end() &&
         one.channel->quantity == "displacement";
}

// An observer takes samples as they are: accelerations are no displacements.
void require_quantities(const study::Study& study, const IdentifiedModel& model,
                        const std::vector<MatchedChannel>& matched,
                        std::vector<modal::MeasuredChannel> outputs, const std::string& file) {
  const bool each_in_si = study.identification && study.identification->unit == io::kEachInSi;
  for (const auto& one : matched) {
    const bool is_seen = index_of(model.seen.outputs, one.channel->name) >= 0;
    if (!is_seen && !is_judge(study, one)) continue;
    set_kind(outputs[static_cast<std::size_t>(one.of_file)], *one.channel, file, each_in_si);
  }
}

Eigen::MatrixXd columns(const Eigen::MatrixXd& all, const std::vector<Column>& wanted) {
  Eigen::MatrixXd part(all.rows(), std::ssize(wanted));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    part.col(static_cast<Eigen::Index>(i)) = wanted[i].sign * all.col(wanted[i].of_file);
  }
  return part;
}

// rms of white noise in each column. Third differences leave 20 times its variance, and next to
// nothing of motion that is slow beside the samples.
Eigen::VectorXd white_part(const Eigen::MatrixXd& values) {
  const auto n = values.rows() - 3;
  const Eigen::MatrixXd third = values.bottomRows(n) - 3.0 * values.middleRows(2, n) +
                                3.0 * values.middleRows(1, n) - values.topRows(n);
  return (third.cwiseAbs2().colwise().mean().transpose() / 20.0).cwiseSqrt();
}

// From the difference of the last two periods of each record: the excitation is not in it.
Eigen::VectorXd noise_of(const recordings::TimeData& data, const Recordings& result) {
  const auto sensors = result.records.empty() ? 0 : result.records[0].sensors.cols();
  const auto all = sensors + std::ssize(result.judges);
  Eigen::VectorXd square = Eigen::VectorXd::Zero(all);
  double count = 0.0;
  for (const auto& record : result.records) {
    const auto n = record.sensors.rows();
    if (data.period < 8 || n < 2 * data.period) continue;
    Eigen::MatrixXd outputs(n, all);
    outputs << record.sensors, record.judges;
    square += white_part(outputs.bottomRows(data.period) -
                         outputs.middleRows(n - 2 * data.period, data.period))
                  .cwiseAbs2();
    count += 2.0;
  }
  if (count == 0.0) {
    return Eigen::VectorXd::Constant(all, std::numeric_limits<double>::quiet_NaN());
  }
  return (square / count).cwiseSqrt();
}

}  // namespace

bool has_recordings(const study::Study& study) { return !file_of(study).empty(); }

Recordings recordings(const study::Study& study, const IdentifiedModel& model, stage::Work& work) {
  const auto path = file_of(study);
  require(std::filesystem::exists(path), path.string() + ": there is no such file");
  require(!stage::has_paths(study), study.file.string() +
                                        ": recordings pass through no gain, delay or low_pass of a "
                                        "channel; expected channels without them");
  const auto file = read_recordings(study, path, recording_options(study, path, work), work);
  Recordings result;
  result.file = path.string();
  result.sample_time_s = file.data.sample_time_s;
  require(result.sample_time_s > 0.0, result.file + ": the sample time is not known");
  const auto outputs = matched_channels(file.data.outputs, study.sensors, result.file, work);
  require_quantities(study, model, outputs, file.data.outputs, result.file);
  const auto inputs = matched_channels(file.data.inputs, study.actuators, result.file, work);
  std::vector<Column> sensors;
  std::vector<Column> judges;
  std::vector<Column> actuators;
  for (const auto& one : model.seen.outputs) {
    sensors.push_back(column(outputs, one.name, result.file));
  }
  for (const auto& one : model.seen.inputs) {
    actuators.push_back(column(inputs, one.name, result.file));
  }
  for (const auto& one : outputs) {
    if (!is_judge(study, one)) continue;
    result.judges.push_back(one.channel->name);
    judges.push_back({one.of_file, one.turned ? -1.0 : 1.0});
  }
  for (const auto& record : file.data.records) {
    result.records.push_back({columns(record.inputs, actuators), columns(record.outputs, sensors),
                              columns(record.outputs, judges)});
  }
  result.noise = noise_of(file.data, result);
  if (study.observer && study.observer->noise > 0.0)
    result.noise.setConstant(study.observer->noise);
  return result;
}

}  // namespace chladni::steps
