// Misfit of a part of the data with given causes and the tolerances that suit the part best.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// ½(χ² + ηᵀη) of the problem's data; infinite where the causes are impossible beside eta.
/// Cost: a solve of all lines.
[[nodiscard]] double misfit_at(const Problem& problem, const std::vector<Supposed>& causes,
                               const Eigen::VectorXd& eta);

/// Least ½(χ² + ηᵀη) of the problem's data over the deviations, with the causes held. It is sought
/// from whichever of `starts` is better, by steps of Levenberg and Marquardt with slopes that are
/// taken anew at each: a cause that moves a narrow resonance by its width leaves the slopes at the
/// start of no use. The value is too large by Constants::nothing_more at most, or by more where
/// Constants::part_steps do not suffice.
/// Infinite where the causes are impossible beside all starts.
/// Cost: a solve of all lines and a slope per deviation for each step.
[[nodiscard]] double least_misfit(const Problem& problem, const std::vector<Supposed>& causes,
                                  const std::vector<Eigen::VectorXd>& starts);

}  // namespace chladni::diagnosis
