#include "recordings/time_data.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/error.h"

namespace chladni::recordings {
namespace {

void check_names(const std::vector<modal::MeasuredChannel>& channels, const std::string& side) {
  std::set<std::string> seen;
  for (const auto& channel : channels) {
    require(!channel.name.empty(), "time data: an " + side + " has no name");
    require(seen.insert(channel.name).second,
            "time data: two channels of the " + side + " side are called \"" + channel.name + "\"");
  }
}

// Reports the first sample that is not finite with its channel and index.
void check_finite(const Eigen::MatrixXd& samples, const std::string& record,
                  const std::vector<modal::MeasuredChannel>& channels) {
  if (samples.allFinite()) return;
  for (Eigen::Index j = 0; j < samples.cols(); ++j) {
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      require(std::isfinite(samples(i, j)),
              record + ", channel \"" + channels[static_cast<std::size_t>(j)].name + "\", sample " +
                  fmt::to_string(i) + " is not finite");
    }
  }
}

}  // namespace

void check(const TimeData& data) {
  require(std::isfinite(data.sample_time_s) && data.sample_time_s > 0.0,
          "time data: the sample time is " + fmt::format("{:.6g}", data.sample_time_s) +
              " s; expected a positive number");
  require(data.period >= 0, "time data: the period is negative");
  require(!data.records.empty(), "time data: no record");
  check_names(data.outputs, "output");
  check_names(data.inputs, "input");
  check_names(data.references, "reference");
  for (std::size_t i = 0; i < data.records.size(); ++i) {
    const auto& record = data.records[i];
    const auto name = "time data: record " + fmt::to_string(i + 1);
    const auto samples = record.outputs.rows();
    const auto fits = [&](const Eigen::MatrixXd& matrix, const auto& channels) {
      return matrix.rows() == samples &&
             matrix.cols() == static_cast<Eigen::Index>(channels.size());
    };
    require(samples >= 1, name + " has no samples");
    require(fits(record.outputs, data.outputs) && fits(record.inputs, data.inputs) &&
                fits(record.references, data.references),
            name + " does not have the samples of " + fmt::to_string(data.outputs.size()) +
                " outputs, " + fmt::to_string(data.inputs.size()) + " inputs and " +
                fmt::to_string(data.references.size()) + " references");
    require(record.experiment >= 0 && record.realisation >= 0,
            name + " has a negative number of experiment or realisation");
    check_finite(record.outputs, name, data.outputs);
    check_finite(record.inputs, name, data.inputs);
    check_finite(record.references, name, data.references);
  }
}

std::string missing_side(const TimeData& head) {
  const auto count = [](std::size_t channels, const std::string& side) {
    return fmt::to_string(channels) + " " + side + (channels == 1 ? "" : "s");
  };
  if (head.outputs.empty()) {
    return "no output (sensor) among the channels, " + count(head.inputs.size(), "input") +
           "; expected one or more of both";
  }
  if (head.inputs.empty()) {
    return "no input (force, command) among the channels, " + count(head.outputs.size(), "output") +
           "; expected one or more of both";
  }
  return "";
}

}  // namespace chladni::recordings
