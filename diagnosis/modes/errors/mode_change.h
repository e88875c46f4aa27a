// First-order changes of modes by an error of the body.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/modes/errors/mode_errors.h"

namespace chladni::diagnosis {

/// n modes of the model, of which some are asked for; the others are 0 here.
struct ModeChange {
  Eigen::VectorXd frequency;        ///< n: of ln f
  Eigen::MatrixXd outputs, inputs;  ///< p×n, q×n
};
/// For an error of deviation 1. Cost: m r² for m modes that are asked for and r coordinates.
/// @param modes  that are asked for, in any order
[[nodiscard]] ModeChange change_by(const BodyError& error, const RecordedModes& model,
                                   const std::vector<Eigen::Index>& modes);

}  // namespace chladni::diagnosis
