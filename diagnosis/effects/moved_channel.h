// A channel that is not at its stated place.
#pragma once

#include "diagnosis/effects/sides.h"
#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// Effect::error of a displaced channel: its new row follows from the shapes around its place.
inline constexpr double kMovedError = 0.005;

/// Change of a channel's row when the channel moves.
struct ChannelChange {
  Eigen::VectorXd shape;  ///< r [kg^-1/2]
  Eigen::VectorXd upper;  ///< in the form of a row of ChannelSide::upper; or empty: not known
};

/// The change for channel i of a side when it moves along the chart by `by` [m]. For a channel
/// along the surface normal the surface gives it exactly. For any other channel it is of first
/// order, without the modes above.
[[nodiscard]] ChannelChange channel_change(const Structure& structure, const ChannelSide& side,
                                           Eigen::Index i, const Eigen::Vector2d& by);

/// Adds the change to the rows and columns of the state.
void move_channel(State& state, Side side, Eigen::Index i, const ChannelChange& change);

}  // namespace chladni::diagnosis
