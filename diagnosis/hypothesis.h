// Causes of a finished diagnosis as a hypothesis: the reduced model with its causes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/calibrated.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// The effect, choice and numbers of a cause. If no single choice acts on all its channels (they
/// were "all of them", but this structure has more), there is one entry for each channel. A
/// permutation of labels is a number of exchanges of two labels, one after the other.
/// @throws InvalidInput  no effect of that name; none of its choices acts on these channels; a
///                       number is missing
[[nodiscard]] std::vector<Supposed> supposed_of(const Cause& cause, const Structure& structure);

/// Receptances of the structure with the fitted causes and all tolerances at 0, [k] each p×q [m/N],
/// as the channels record them. This predicts also channels and lines that were held out of the
/// fit. No finite elements are solved.
/// @param frequency_hz  k, above 0
/// @throws as supposed_of; NumericalFailure  a cause removes more stiffness than there is
[[nodiscard]] std::vector<Eigen::MatrixXcd> predicted(const Structure& structure,
                                                      const std::vector<Cause>& causes,
                                                      const Eigen::VectorXd& frequency_hz);
/// The same with calibrated constants of the study, as the fits have them: each mode keeps its
/// damping ratio. Those that are not determined keep the study's value.
/// @throws InvalidInput  as predicted; a constant has no effect
[[nodiscard]] std::vector<Eigen::MatrixXcd> predicted(
    const Structure& structure, const std::vector<CalibratedNumber>& constants,
    const std::vector<Cause>& causes, const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::diagnosis
