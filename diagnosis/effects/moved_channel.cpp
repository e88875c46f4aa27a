#include "diagnosis/effects/moved_channel.h"

#include <cmath>

namespace chladni::diagnosis {

using Eigen::VectorXd;

namespace {

// The modes above at a point, with the last one set to 0: it stands for all modes beyond, and it is
// 0 for every channel.
VectorXd upper_of(const PointMotion& motion, Eigen::Index size) {
  VectorXd result = motion.upper;
  if (result.size() != size || size == 0) return {};
  result(size - 1) = 0.0;
  return result;
}

}  // namespace

ChannelChange channel_change(const Structure& structure, const ChannelSide& side, Eigen::Index i,
                             const Eigen::Vector2d& by) {
  const Eigen::Vector2d place = side.places.row(i);
  const VectorXd first_order =
      (by(0) * side.slope_u.row(i) + by(1) * side.slope_v.row(i)).transpose();
  if (structure.surface.at == nullptr) return {first_order, {}};
  const auto here = structure.surface.at(place);
  const auto there = structure.surface.at(place + by);
  if (!here || !there) return {first_order, {}};
  // The surface knows only the motion along its normal.
  const double along = here->shape.dot(side.shapes.row(i));
  const double own = here->shape.squaredNorm();
  if (own <= 0.0) return {first_order, {}};
  const double sign = along / own;
  const bool normal = std::abs(std::abs(sign) - 1.0) < 0.02;
  if (!normal) return {first_order, {}};
  const auto above = side.upper.cols();
  const VectorXd upper = sign * (upper_of(*there, above) - upper_of(*here, above));
  return {sign * (there->shape - here->shape), upper};
}

void move_channel(State& state, Side side, Eigen::Index i, const ChannelChange& change) {
  const bool above = change.upper.size() > 0 && change.upper.size() == state.output_upper.cols();
  if (side == Side::sensors) {
    state.outputs.row(i) += change.shape.transpose();
    if (!above) return;
    state.residual.row(i) += (state.input_upper * change.upper).transpose();
    state.output_upper.row(i) += change.upper.transpose();
  } else {
    state.inputs.col(i) += change.shape;
    if (!above) return;
    state.residual.col(i) += state.output_upper * change.upper;
    state.input_upper.row(i) += change.upper.transpose();
  }
}

}  // namespace chladni::diagnosis
