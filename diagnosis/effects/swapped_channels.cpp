#include <utility>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

std::vector<Parameter> none(const Structure& /*structure*/) { return {}; }

template <Side side>
Index pairs(const Structure& structure) {
  const Index n = channels_of<side>(structure).count();
  return n * (n - 1) / 2;
}

template <Side side>
std::vector<std::string> both(const Structure& structure, Index option) {
  const auto& names = channels_of<side>(structure).names;
  const auto [a, b] = pair_of(channels_of<side>(structure).count(), option);
  return {names[static_cast<std::size_t>(a)], names[static_cast<std::size_t>(b)]};
}

template <Side side>
void swap_labels(State& state, const Structure& structure, Index option,
                 const Eigen::VectorXd& /*x*/) {
  const auto [a, b] = pair_of(channels_of<side>(structure).count(), option);
  auto& of = side == Side::sensors ? state.output_of : state.input_of;
  std::swap(of[static_cast<std::size_t>(a)], of[static_cast<std::size_t>(b)]);
}

// Rows that fit each other's place better than their own.
template <Side side>
std::vector<EffectStart> swapped(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (Index option = 0; option < pairs<side>(scene.structure()); ++option) {
    starts.push_back({option, {}});
  }
  return starts;
}

}  // namespace

const Effect swapped_sensors{"swapped_sensors",
                             "two sensors carry each other's name",
                             "two rows of the responses exchanged",
                             "two wrong places at once",
                             none,
                             pairs<Side::sensors>,
                             both<Side::sensors>,
                             swap_labels<Side::sensors>,
                             swapped<Side::sensors>};
const Effect swapped_actuators{"swapped_actuators",
                               "two actuators carry each other's name",
                               "two columns of the responses exchanged",
                               "two wrong places at once",
                               none,
                               pairs<Side::actuators>,
                               both<Side::actuators>,
                               swap_labels<Side::actuators>,
                               swapped<Side::actuators>};

}  // namespace chladni::diagnosis
