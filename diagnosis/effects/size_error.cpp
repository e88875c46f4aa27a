#include <cmath>

#include "diagnosis/body_fields.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/moved_channel.h"
#include "diagnosis/search/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

std::vector<Parameter> relative_size(const Structure& /*structure*/) {
  return {{.name = "relative",
           .unit = "1",
           .scale = Parameter::Scale::relative,
           .is_size = true,
           .width = 0.05,
           .step = 1e-5}};
}

Index size_bends(const Structure& structure) {
  return structure.bending_power > 0.0 && structure.cells.count() > 0 ? 1 : 0;
}

MatrixXd all_of(const std::vector<MatrixXd>& cells, double weight, Index modes) {
  if (cells.empty()) return MatrixXd::Zero(modes, modes);
  return sum_of(cells, VectorXd::Constant(static_cast<Index>(cells.size()), weight));
}

// The channels keep their place in space, so on the larger body they move.
template <Side side>
std::vector<ChannelChange> moved(const Structure& structure, double longer) {
  const Vector2d middle = structure.cells.from + 0.5 * structure.cells.size;
  const auto& channels = channels_of<side>(structure);
  std::vector<ChannelChange> changes;
  for (Index i = 0; i < channels.count(); ++i) {
    const Vector2d place = channels.places.row(i);
    changes.push_back(
        channel_change(structure, channels, i, (1.0 / longer - 1.0) * (place - middle)));
  }
  return changes;
}

// What the study attaches keeps its place, too: on the body it moves by (1/λ - 1) of its place, and
// its turns go as 1/λ.
MatrixXd gain_of(const GrownForms& forms, double by) {
  return forms.count() > 0 ? forms.gain(by) : MatrixXd();
}

// w(x/λ): curvatures go as λ^-2, slopes as 1/λ, areas as λ². Shear stiffness and rotary inertia do
// not change.
std::function<void(State&)> stretching(const Structure& structure, Index /*option*/,
                                       const VectorXd& x) {
  const double longer = std::exp(x(0));
  const double area = longer * longer;
  const double by = 1.0 - 1.0 / longer;
  const Index r = structure.mode_count();
  return
      [area, shear = all_of(structure.cells.shear, 1.0 - 1.0 / area, r),
       turning = all_of(structure.cells.rotary, 1.0 - area, r),
       outputs = moved<Side::sensors>(structure, longer),
       inputs = moved<Side::actuators>(structure, longer),
       springs = gain_of(structure.grown.springs, by), masses = gain_of(structure.grown.masses, by),
       dashpots = gain_of(structure.grown.dashpots, by)](State& state) {
        scale_stiffness(state, 1.0 / area);
        scale_mass(state, area);
        state.stiffness += shear;
        state.mass += turning;
        if (springs.size() > 0) attach_stiffness(state, springs);
        if (masses.size() > 0) attach_mass(state, masses);
        if (dashpots.size() > 0) attach_damping(state, dashpots);
        for (std::size_t i = 0; i < outputs.size(); ++i) {
          move_channel(state, Side::sensors, static_cast<Index>(i), outputs[i]);
        }
        for (std::size_t j = 0; j < inputs.size(); ++j) {
          move_channel(state, Side::actuators, static_cast<Index>(j), inputs[j]);
        }
      };
}

// Frequencies go as λ^-2.
std::vector<EffectStart> size_steps(const Scene& scene) {
  std::vector<EffectStart> starts{{0, VectorXd::Zero(1)}};
  for (double by = 0.5 * scene.frequency_step(); by < 0.15; by *= 1.4) {
    starts.push_back({0, VectorXd::Constant(1, by)});
    starts.push_back({0, VectorXd::Constant(1, -by)});
  }
  return starts;
}

}  // namespace

constinit const Effect size_error{
    .name = "size_error",
    .summary = "the body is longer and wider than its drawing, or smaller",
    .source = "K as 1/l^2 but for shear, M as l^2; channels and attached parts stay where they are",
    .confusable = "modulus and density together: measure it",
    .parameters = relative_size,
    .options = size_bends,
    .channels = no_channels,
    .apply = at_once<stretching>,
    .starts = size_steps,
    .change = stretching,
    .error = 0.005,
    .is_of_body = true,
    .in_study = {.table = InStudy::Table::geometry,
                 .keys = {{"length", "relative", "", StudyKey::How::times_one_plus},
                          {"width", "relative", "", StudyKey::How::times_one_plus},
                          {"diameter", "relative", "", StudyKey::How::times_one_plus}}},
};

}  // namespace chladni::diagnosis
