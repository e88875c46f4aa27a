// A first guess of the delay, before the modes are known well.
#pragma once

#include "identification/fit_data.h"

namespace chladni::identification {

/// The delay [s] under which real residues at these poles fit best, between −0.5 and 2.5 periods
/// of the highest line. Poles barely feel a delay, the phases of their residues do.
/// Cost: a hundred linear fits of the residues.
[[nodiscard]] double scanned_delay(const FitData& data, const Eigen::VectorXcd& poles, bool rigid);

/// The data as they would be without it: G e^{+sτ}.
[[nodiscard]] FitData undelayed(const FitData& data, double delay_s);

}  // namespace chladni::identification
