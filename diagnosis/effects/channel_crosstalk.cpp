#include <algorithm>

#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/sides.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXd;

std::vector<Parameter> share(const Structure& /*structure*/) {
  return {{.name = "share", .unit = "1", .is_size = true, .width = 0.05, .step = 1e-5}};
}

// Ordered pairs: the disturbed channel and the disturbing one.
struct Spoilt {
  Index channel, by;
};
Spoilt spoilt(Index n, Index option) {
  const Index channel = option / (n - 1);
  const Index other = option % (n - 1);
  return {channel, other < channel ? other : other + 1};
}

template <Side side>
Index ordered_pairs(const Structure& structure) {
  const Index n = channels_of<side>(structure).count();
  return n * (n - 1);
}

template <Side side>
std::vector<std::string> both(const Structure& structure, Index option) {
  const auto& names = channels_of<side>(structure).names;
  const auto [channel, by] = spoilt(channels_of<side>(structure).count(), option);
  return {names[static_cast<std::size_t>(channel)], names[static_cast<std::size_t>(by)]};
}

template <Side side>
void mix(State& state, const Structure& structure, Index option, const VectorXd& x) {
  const auto [channel, by] = spoilt(channels_of<side>(structure).count(), option);
  const auto add_row = [&](Eigen::MatrixXd& rows) {
    if (rows.cols() > 0) rows.row(channel) += x(0) * rows.row(by);
  };
  if (side == Side::sensors) {
    add_row(state.outputs);
    add_row(state.output_upper);
    add_row(state.residual);
    for (auto& frame : state.frames) frame.to_outputs(channel) += x(0) * frame.to_outputs(by);
  } else {
    state.inputs.col(channel) += x(0) * state.inputs.col(by);
    add_row(state.input_upper);
    state.residual.col(channel) += x(0) * state.residual.col(by);
    for (auto& frame : state.frames) frame.from_inputs(channel) += x(0) * frame.from_inputs(by);
  }
}

// First-order change of the responses by the share of a pair, K×pq.
template <Side side>
MatrixXcd added(const Scene& scene, const Spoilt& pair) {
  const MatrixXcd& now = scene.now().value;
  const Index p = scene.structure().output_count();
  const Index q = scene.structure().input_count();
  MatrixXcd change = MatrixXcd::Zero(now.rows(), now.cols());
  if (side == Side::sensors) {
    for (Index j = 0; j < q; ++j) change.col(pair.channel + p * j) = now.col(pair.by + p * j);
  } else {
    change.middleCols(p * pair.channel, p) = now.middleCols(p * pair.by, p);
  }
  return change;
}

// The likeliest pairs, each with its best share to first order.
template <Side side>
std::vector<EffectStart> likeliest(const Scene& scene) {
  constexpr std::size_t kKept = 6;
  struct Promise {
    double fall;
    EffectStart start;
  };
  std::vector<Promise> all;
  const Index n = channels_of<side>(scene.structure()).count();
  for (Index option = 0; option < ordered_pairs<side>(scene.structure()); ++option) {
    const auto gain = scene.gain(added<side>(scene, spoilt(n, option)));
    all.push_back({gain.fall, {option, VectorXd::Constant(1, std::clamp(gain.step, -0.25, 0.25))}});
  }
  std::ranges::stable_sort(all, std::greater{}, &Promise::fall);
  std::vector<EffectStart> starts;
  for (std::size_t n_kept = 0; n_kept < std::min(kKept, all.size()); ++n_kept) {
    starts.push_back(all[n_kept].start);
  }
  return starts;
}

constexpr std::string_view kInTheRecords =
    "it is in the records: take the share of the other channel off them";

}  // namespace

constinit const Effect sensor_crosstalk{
    .name = "sensor_crosstalk",
    .summary = "a sensor's record carries a share of another's",
    .source = "a row of C and of the residual plus a share of another",
    .confusable = "the place of that sensor, a support that moves",
    .parameters = share,
    .options = ordered_pairs<Side::sensors>,
    .channels = both<Side::sensors>,
    .apply = mix<Side::sensors>,
    .starts = likeliest<Side::sensors>,
    .in_study = {.refusal = kInTheRecords},
};
constinit const Effect actuator_crosstalk{
    .name = "actuator_crosstalk",
    .summary = "an actuator also gives a share of another's force",
    .source = "a column of B and of the residual plus a share of another",
    .confusable = "the place of that actuator",
    .parameters = share,
    .options = ordered_pairs<Side::actuators>,
    .channels = both<Side::actuators>,
    .apply = mix<Side::actuators>,
    .starts = likeliest<Side::actuators>,
    .in_study = {.refusal = kInTheRecords},
};

}  // namespace chladni::diagnosis
