// What no measured response tells: shapes of channels without one, and the scale between parts of
// the channels that none connects. Used in this room only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/likelihood/block_model.h"
#include "identification/modal_fit.h"
#include "identification/poles/completion.h"

namespace chladni::identification {

using Parts = std::vector<ConnectedChannels>;

/// The block with zeros at all channels outside of one part.
[[nodiscard]] Block block_at(const Block& block, const ConnectedChannels& part);

/// The same measured responses with the rules of ModalFit (ComplexShapes for a general block) in
/// each part by itself: equal lengths of both sides, the phase, a positive largest output. Channels
/// of a part in which one side is zero become zero. Blocks of several modes stay as they are.
[[nodiscard]] Block balanced_in_parts(const Block& block, const Parts& parts);

/// The part that sees the block best: that with the largest Σ w² |residue|².
/// @param weight  p×q: Σ w² of each response, 0 where it is not measured
/// @pre one part or more
[[nodiscard]] std::size_t home_part(const Block& block, const Eigen::MatrixXd& weight,
                                    const Parts& parts);

/// Sets infinite deviations at all channels outside of each mode's home, with zero covariances
/// beside them: the data tell no scale and no sign between parts.
/// @param home  m: a part for each mode
void mark_other_parts(const Parts& parts, const std::vector<std::size_t>& home, ModalFit& fit);

/// Sets infinite deviations where no data exist: residuals, shapes and rigid-body rows of channels
/// without a measured response.
/// @param weight  p×q, for each response; 0 where it is not measured
void mark_unmeasured(const Eigen::MatrixXd& weight, ModalFit& fit);

}  // namespace chladni::identification
