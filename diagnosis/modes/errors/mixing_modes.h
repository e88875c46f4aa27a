// Modes that mix with a mode of a hypothesis in ways that no model knows.
#pragma once

#include <vector>

#include "diagnosis/modes/matching.h"

namespace chladni::diagnosis {

/// A mode whose shape another one has a part of.
struct MixingMode {
  Eigen::Index mode;  ///< of the model, or a measured one
  double part;        ///< [1] deviation of the part; by stiffness for an error of frequency of 1
};

/// Modes near mode k that errors of stiffness and mass mix with a partner of these parts: 1 / gap,
/// less as they come to Constants::nearby. Their parts are real. A repeated mode k that the partner
/// is turned away from is one of them: what counts is what each has across the partner.
/// @param parts  n: Partner::parts
[[nodiscard]] std::vector<MixingMode> mixed_by_stiffness(const RecordedModes& model, Eigen::Index k,
                                                         const Eigen::VectorXd& parts);

/// Other measured modes, by index, whose partners damping mixes with measured mode i, whose dampers
/// no study knows. Their parts are taken as imaginary: Constants::damping_coupling times √(ζ_i ζ_j)
/// over the distance of the measured poles (over ω), at most 1, and less as they come to
/// Constants::nearby (Caughey and O'Kelly, J. Appl. Mech. 32, 1965: what is not diagonal in the
/// modes' damping). Poles of one frequency mix in their real parts too, as mixed_by_stiffness has
/// them.
[[nodiscard]] std::vector<MixingMode> mixed_by_damping(const MeasuredModes& measured,
                                                       const RecordedModes& model,
                                                       const Matching& matching, Eigen::Index i);

/// What modes bring at some channels, times their parts: p×c.
/// @param shapes  p×n: of the modes; in shapes_across of those of the model, and `own` (p) that of
///                the partner with these parts, across which they are taken
[[nodiscard]] Eigen::MatrixXd shapes_mixed(const std::vector<MixingMode>& modes,
                                           const Eigen::MatrixXd& shapes);
[[nodiscard]] Eigen::MatrixXd shapes_across(const std::vector<MixingMode>& modes,
                                            const Eigen::MatrixXd& shapes,
                                            const Eigen::VectorXd& own,
                                            const Eigen::VectorXd& parts);

}  // namespace chladni::diagnosis
