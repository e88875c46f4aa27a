#include "priors/gaussian_process/exponential.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/cpu_clones.h"

namespace chladni::priors {
namespace {

// x = k ln 2 + r, |r| ≤ ln 2 / 2. The Taylor series of e^r to the thirteenth power has an error of
// 4e-18. The addition of 1.5·2⁵² leaves k in the lowest bits. The compiler makes one version for
// each kind of processor.
CHLADNI_WIDE
void exponentiate_all(double* x, std::ptrdiff_t count) {
  constexpr double kShift = 6755399441055744.0;
  constexpr double kLogTwoHigh = 6.93145751953125e-1;
  constexpr double kLogTwoLow = 1.42860682030941723212e-6;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const double at = x[i] < -690.0 ? -690.0 : x[i];
    const double shifted = at * 1.4426950408889634 + kShift;
    const double k = shifted - kShift;
    const double r = (at - k * kLogTwoHigh) - k * kLogTwoLow;
    double p = 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r + 1.0;
    p = p * r + 1.0;
    const auto exponent = (std::bit_cast<std::uint64_t>(shifted) << 52U) + 0x3ff0000000000000ULL;
    x[i] = p * std::bit_cast<double>(exponent);
  }
}

}  // namespace

void exponentiate(Eigen::ArrayXd& x) { exponentiate_all(x.data(), x.size()); }

}  // namespace chladni::priors
