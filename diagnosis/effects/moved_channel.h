// A channel that is not where it says.
#pragma once

#include "diagnosis/structure.h"

namespace chladni::diagnosis {

/// Effect::error of a channel that is elsewhere: what it sees follows from the shapes around it.
inline constexpr double kMovedError = 0.005;

/// What the shapes at channel i of a side change by when it is moved along the chart by `by` [m], r
/// [kg^-1/2]: as the surface has it for a channel along its normal, to first order for any other.
[[nodiscard]] Eigen::VectorXd shape_change(const Structure& structure, const ChannelSide& side,
                                           Eigen::Index i, const Eigen::Vector2d& by);

}  // namespace chladni::diagnosis
