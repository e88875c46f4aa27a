#include "diagnosis/readings/channels_read.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string_view>

#include "base/index.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/fit/responses.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// Choices of an effect that act on exactly these channels; `delay` acts on all sensors.
std::vector<Index> options_on(const Structure& structure, const Effect& effect,
                              const ChannelsRead& read) {
  const auto& side = read.sensors ? structure.outputs : structure.inputs;
  std::vector<std::string> names;
  for (const auto c : read.channels) names.push_back(side.names[at(c)]);
  std::vector<Index> options;
  for (Index option = 0; option < effect.options(structure); ++option) {
    auto on = effect.channels(structure, option);
    if (on.empty() && read.sensors) on = structure.outputs.names;
    if (on == names) options.push_back(option);
  }
  return options;
}

// The factor of causes on the records of these channels.
VectorXcd factor_of(const Structure& structure, const ChannelsRead& read,
                    const std::vector<Supposed>& causes, const VectorXd& omega) {
  State state = state_of(structure);
  for (const auto& cause : causes) cause.effect->apply(state, structure, cause.option, cause.x);
  VectorXcd factor(omega.size());
  for (Index k = 0; k < omega.size(); ++k) {
    const std::complex<double> s(0.0, omega(k));
    const auto all = factors(read.sensors ? state.output_paths : state.input_paths, s);
    factor(k) = all(read.channels.front());
  }
  return factor;
}

using Ways = std::vector<std::vector<Supposed>>;  // each none or some causes; the first is none

// Each of `few`, with and without each choice of the effect, at each x.
Ways with(const Structure& structure, const ChannelsRead& read, const Effect& effect,
          const std::vector<VectorXd>& xs, const Ways& few) {
  Ways more = few;
  for (const auto option : options_on(structure, effect, read)) {
    for (const auto& x : xs) {
      const Supposed cause{&effect, option, x};
      if (!std::isfinite(log_prior(cause, structure))) continue;
      for (auto causes : few) {
        causes.push_back(cause);
        more.push_back(std::move(causes));
      }
    }
  }
  return more;
}

std::vector<ReadingPart> parts_of(const Structure& structure, const ChannelsRead& read,
                                  const Ways& few, const VectorXd& omega) {
  std::vector<ReadingPart> parts;
  for (const auto& causes : few) {
    parts.push_back({causes, factor_of(structure, read, causes, omega)});
  }
  return parts;
}

// Fills in the readings of the channels.
ChannelsRead filled(const Structure& structure, const std::vector<const Effect*>& catalogue,
                    ChannelsRead read, const VectorXd& omega, const VectorXd& delays) {
  const auto add = [&](const Effect& effect, const std::vector<VectorXd>& xs, Ways& few) {
    if (std::ranges::find(catalogue, &effect) == catalogue.end()) return;
    few = with(structure, read, effect, xs, few);
  };
  std::vector<VectorXd> late;
  for (const double by : delays) late.emplace_back(VectorXd::Constant(1, by));
  const bool all = read.channels.size() > 1 || structure.output_count() == 1;
  Ways scales(1);
  Ways shapes(1);
  if (read.sensors) {
    add(sensor_sign, {VectorXd(0)}, scales);
    add(sensor_unit, {VectorXd(0)}, scales);
    add(sensor_quantity, {VectorXd(0)}, shapes);
    add(all ? delay : sensor_delay, late, shapes);
  } else {
    add(actuator_sign, {VectorXd(0)}, scales);
    add(actuator_delay, late, shapes);
  }
  read.scales = parts_of(structure, read, scales, omega.head(1));
  read.shapes = parts_of(structure, read, shapes, omega);
  return read;
}

}  // namespace

std::vector<ChannelsRead> channels_read(const Structure& structure,
                                        const std::vector<const Effect*>& catalogue,
                                        const VectorXd& omega, const VectorXd& delays) {
  std::vector<ChannelsRead> sets;
  std::vector<Index> sensors;
  for (Index i = 0; i < structure.output_count(); ++i) {
    sensors.push_back(i);
    sets.push_back({true, {i}, {}, {}});
  }
  for (Index j = 0; j < structure.input_count(); ++j) sets.push_back({false, {j}, {}, {}});
  if (sensors.size() > 1) sets.push_back({true, sensors, {}, {}});
  for (auto& set : sets) {
    set = filled(structure, catalogue, std::move(set), omega, delays);
  }
  std::erase_if(sets, [](const auto& set) { return set.scales.size() * set.shapes.size() < 2; });
  return sets;
}

}  // namespace chladni::diagnosis
