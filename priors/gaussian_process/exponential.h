// Exponential function for arrays of the size of a covariance.
#pragma once

#include <Eigen/Core>

namespace chladni::priors {

/// exp(x) to 2 units in the last place for x ≤ 0; values below −690 count as −690. With AVX2 or
/// AVX-512 it is four to ten times as fast as the library's function.
void exponentiate(Eigen::ArrayXd& x);

}  // namespace chladni::priors
