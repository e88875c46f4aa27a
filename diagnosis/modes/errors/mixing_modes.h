// Modes that mix with a mode of a hypothesis in ways that no model knows.
#pragma once

#include <vector>

#include "diagnosis/modes/matching.h"

namespace chladni::diagnosis {

/// A mode l whose shape mode k has a part of.
struct MixingMode {
  Eigen::Index mode;  ///< l, of the model
  double part;        ///< [1] deviation of the part; by stiffness for an error of frequency of 1
};

/// Modes near mode k that errors of stiffness and mass mix with it: 1 / gap, less as they come to
/// Constants::nearby. Their parts are real.
[[nodiscard]] std::vector<MixingMode> mixed_by_stiffness(const RecordedModes& model,
                                                         Eigen::Index k);

/// Partners of other measured modes that damping mixes with measured mode i, whose dampers no study
/// knows. Their parts are taken as imaginary: Constants::damping_coupling times √(ζ_i ζ_j) over the
/// distance of the measured poles (over ω), at most 1, and less as they come to Constants::nearby
/// (Caughey and O'Kelly, J. Appl. Mech. 32, 1965: what is not diagonal in the modes' damping).
/// Poles of one frequency mix in their real parts too, as mixed_by_stiffness has them.
[[nodiscard]] std::vector<MixingMode> mixed_by_damping(const MeasuredModes& measured,
                                                       const RecordedModes& model,
                                                       const Matching& matching, Eigen::Index i);

}  // namespace chladni::diagnosis
