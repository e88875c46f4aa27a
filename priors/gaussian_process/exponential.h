// e to a power, for as many numbers as a covariance has.
#pragma once

#include <Eigen/Core>

namespace chladni::priors {

/// exp(x) to 2 units in the last place for x ≤ 0; what lies below −690 counts as −690. Four to ten
/// times as fast as the library's where the processor has AVX2 or AVX-512.
void exponentiate(Eigen::ArrayXd& x);

}  // namespace chladni::priors
