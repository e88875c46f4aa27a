#include <cmath>

#include "diagnosis/body_fields.h"
#include "diagnosis/effects/entries.h"
#include "diagnosis/effects/moved_channel.h"
#include "diagnosis/scene.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

std::vector<Parameter> relative(const Structure& /*structure*/) {
  return {{"relative", "1", Parameter::Scale::relative, 0.0, 0.05, 1e-5}};
}

Index bends(const Structure& structure) {
  return structure.bending_power > 0.0 && structure.cells.count() > 0 ? 1 : 0;
}

// w(x/λ): curvatures go as λ^-2, slopes as 1/λ, areas as λ²; what the shear resists and what turns
// keep their size.
void scale_body(State& state, const BodyCells& cells, double longer) {
  const double area = longer * longer;
  scale_stiffness(state, 1.0 / area);
  state.mass *= area;
  const auto all_cells = [&](double value) { return VectorXd::Constant(cells.count(), value); };
  if (!cells.shear.empty()) state.stiffness += sum_of(cells.shear, all_cells(1.0 - 1.0 / area));
  if (!cells.rotary.empty()) state.mass += sum_of(cells.rotary, all_cells(1.0 - area));
}

// The channels stay where they are, so that on the body they move.
void stretch(State& state, const Structure& structure, Index /*option*/, const VectorXd& x) {
  const double longer = std::exp(x(0));
  scale_body(state, structure.cells, longer);
  const Vector2d middle = structure.cells.from + 0.5 * structure.cells.size;
  const auto by = [&](const ChannelSide& side, Index i) -> VectorXd {
    const Vector2d place = side.places.row(i);
    return shape_change(structure, side, i, (1.0 / longer - 1.0) * (place - middle));
  };
  for (Index i = 0; i < structure.output_count(); ++i) {
    state.outputs.row(i) += by(structure.outputs, i).transpose();
  }
  for (Index j = 0; j < structure.input_count(); ++j) {
    state.inputs.col(j) += by(structure.inputs, j);
  }
}

// Frequencies go as λ^-2.
std::vector<EffectStart> steps(const Scene& scene) {
  std::vector<EffectStart> starts{{0, VectorXd::Zero(1)}};
  for (double by = 0.5 * scene.frequency_step(); by < 0.15; by *= 1.4) {
    starts.push_back({0, VectorXd::Constant(1, by)});
    starts.push_back({0, VectorXd::Constant(1, -by)});
  }
  return starts;
}

}  // namespace

const Effect size_error{"size_error",
                        "the body is longer and wider than its drawing, or smaller",
                        "K as 1/l^2 but for shear, M as l^2; channels stay where they are",
                        "modulus and density together: measure it",
                        relative,
                        bends,
                        no_channels,
                        stretch,
                        steps};

}  // namespace chladni::diagnosis
