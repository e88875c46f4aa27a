// A channel that is not where it says.
#pragma once

#include "diagnosis/effects/sides.h"
#include "diagnosis/fit/state.h"

namespace chladni::diagnosis {

/// Effect::error of a channel that is elsewhere: what it sees follows from the shapes around it.
inline constexpr double kMovedError = 0.005;

/// What a channel sees more when it is elsewhere.
struct ChannelChange {
  Eigen::VectorXd shape;  ///< r [kg^-1/2]
  Eigen::VectorXd upper;  ///< as a row of ChannelSide::upper, or empty: not known
};

/// Of channel i of a side that is moved along the chart by `by` [m]: as the surface has it for a
/// channel along its normal, to first order, without the modes above, for any other.
[[nodiscard]] ChannelChange channel_change(const Structure& structure, const ChannelSide& side,
                                           Eigen::Index i, const Eigen::Vector2d& by);

/// Puts it into the rows and columns of the state.
void move_channel(State& state, Side side, Eigen::Index i, const ChannelChange& change);

}  // namespace chladni::diagnosis
