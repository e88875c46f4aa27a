// What a diagnosis told, as a hypothesis again: the reduced model with its causes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// The effect with the choice and the numbers that a cause tells; of a structure that has more
/// channels than the cause names as "all of them", one for each channel.
/// @throws InvalidInput  no effect of that name, none of its choices acts on these channels, a
///                       number is missing
[[nodiscard]] std::vector<Supposed> supposed_of(const Cause& cause, const Structure& structure);

/// Receptances of the structure with the causes as they were fitted and all tolerances at rest,
/// [k] each p×q [m/N], as the channels record them: what the fit predicts also where it did not
/// look, on channels and lines that were held out. No finite elements are solved.
/// @param frequency_hz  k, above 0
/// @throws as supposed_of; NumericalFailure  a cause takes away more stiffness than there is
[[nodiscard]] std::vector<Eigen::MatrixXcd> predicted(const Structure& structure,
                                                      const std::vector<Cause>& causes,
                                                      const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::diagnosis
