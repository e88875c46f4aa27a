#include <utility>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

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

// Every pair of channels.
template <Side side>
std::vector<EffectStart> swapped(const Scene& scene) {
  std::vector<EffectStart> starts;
  for (Index option = 0; option < pairs<side>(scene.structure()); ++option) {
    starts.push_back({option, {}});
  }
  return starts;
}

constexpr InStudy exchanged_names(InStudy::Table table) {
  return {.table = table,
          .keys = {{.key = "name", .how = StudyKey::How::computed},
                   {.key = "node", .how = StudyKey::How::computed}}};
}

}  // namespace

constinit const Effect swapped_sensors{
    .name = "swapped_sensors",
    .summary = "two sensors carry each other's name",
    .source = "two rows of the responses exchanged",
    .confusable = "two wrong places at once",
    .parameters = no_sizes,
    .options = pairs<Side::sensors>,
    .channels = both<Side::sensors>,
    .apply = swap_labels<Side::sensors>,
    .starts = swapped<Side::sensors>,
    .in_study = exchanged_names(InStudy::Table::sensors),
};
constinit const Effect swapped_actuators{
    .name = "swapped_actuators",
    .summary = "two actuators carry each other's name",
    .source = "two columns of the responses exchanged",
    .confusable = "two wrong places at once",
    .parameters = no_sizes,
    .options = pairs<Side::actuators>,
    .channels = both<Side::actuators>,
    .apply = swap_labels<Side::actuators>,
    .starts = swapped<Side::actuators>,
    .in_study = exchanged_names(InStudy::Table::actuators),
};

}  // namespace chladni::diagnosis
