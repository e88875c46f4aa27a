#include "stage/channel_paths.h"

#include <algorithm>
#include <numbers>

namespace chladni::stage {
namespace {

bool is_plain(const study::Channel& channel) {
  return channel.gain == 1.0 && channel.delay == 0.0 && channel.low_pass_hz == 0.0;
}

const study::Channel* named(const std::vector<study::Channel>& channels, const std::string& name) {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const study::Channel& one) { return one.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

std::vector<const study::Channel*> named(const std::vector<study::Channel>& channels,
                                         const std::vector<modal::MeasuredChannel>& measured) {
  std::vector<const study::Channel*> result;
  for (const auto& one : measured) result.push_back(named(channels, one.name));
  return result;
}

void multiply(modal::FrfSet& set, std::size_t k, Eigen::Index i, Eigen::Index j,
              std::complex<double> by) {
  set.value[k](i, j) *= by;
  if (!set.variance.empty()) set.variance[k](i, j) *= std::norm(by);
  if (!set.noise_variance.empty()) set.noise_variance[k](i, j) *= std::norm(by);
}

modal::FrfSet through_paths(const study::Study& study, modal::FrfSet set, bool forth) {
  if (!has_paths(study)) return set;
  const auto outputs = named(study.sensors, set.outputs);
  const auto inputs = named(study.actuators, set.inputs);
  const auto factor = [&](const study::Channel* channel, double f) {
    return channel == nullptr ? std::complex<double>(1.0) : path(*channel, f);
  };
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const double f = set.frequency_hz(static_cast<Eigen::Index>(k));
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      for (std::size_t j = 0; j < inputs.size(); ++j) {
        const auto by = factor(outputs[i], f) * factor(inputs[j], f);
        multiply(set, k, static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j),
                 forth ? by : 1.0 / by);
      }
    }
  }
  return set;
}

}  // namespace

std::complex<double> path(const study::Channel& channel, double frequency_hz) {
  const double turns = 2.0 * std::numbers::pi * frequency_hz;
  const double lag = channel.low_pass_hz > 0.0 ? frequency_hz / channel.low_pass_hz : 0.0;
  return std::polar(channel.gain, -turns * channel.delay) / std::complex<double>(1.0, lag);
}

bool has_paths(const study::Study& study) {
  return !std::all_of(study.sensors.begin(), study.sensors.end(), is_plain) ||
         !std::all_of(study.actuators.begin(), study.actuators.end(), is_plain);
}

modal::FrfSet recorded(const study::Study& study, modal::FrfSet responses) {
  return through_paths(study, std::move(responses), true);
}

modal::FrfSet without_paths(const study::Study& study, modal::FrfSet records) {
  return through_paths(study, std::move(records), false);
}

}  // namespace chladni::stage
