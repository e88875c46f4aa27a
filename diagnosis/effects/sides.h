// Templates for effects that exist for sensors and for actuators.
#pragma once

#include "diagnosis/effect.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {

enum class Side { sensors, actuators };

template <Side side>
[[nodiscard]] const ChannelSide& channels_of(const Structure& structure) {
  return side == Side::sensors ? structure.outputs : structure.inputs;
}
template <Side side>
[[nodiscard]] std::vector<Path>& paths_of(State& state) {
  return side == Side::sensors ? state.output_paths : state.input_paths;
}
/// One option per channel. None if there is only one channel: then all channels have the same
/// error.
template <Side side>
[[nodiscard]] Eigen::Index each_channel(const Structure& structure) {
  const Eigen::Index count = channels_of<side>(structure).count();
  return count > 1 ? count : 0;
}
template <Side side>
[[nodiscard]] std::vector<std::string> the_channel(const Structure& structure,
                                                   Eigen::Index option) {
  return {channels_of<side>(structure).names[static_cast<std::size_t>(option)]};
}
template <Side side>
[[nodiscard]] double channel_factor(const Scene& scene, Eigen::Index channel) {
  return side == Side::sensors ? scene.row_factor(channel) : scene.column_factor(channel);
}
/// The pair a < b of n channels, counted row by row.
[[nodiscard]] inline std::pair<Eigen::Index, Eigen::Index> pair_of(Eigen::Index n,
                                                                   Eigen::Index option) {
  Eigen::Index a = 0;
  while (option >= n - 1 - a) option -= n - 1 - a++;
  return {a, a + 1 + option};
}

}  // namespace chladni::diagnosis
