#include "base/search.h"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/error.h"

namespace chladni {
namespace {

constexpr std::uintmax_t kMostEvaluations = 400;  // bisection alone takes some 60
constexpr int kHalfOfTheDigits = std::numeric_limits<double>::digits / 2;

void require_range(double low, double high) {
  require(high > low, "search: the upper end of the range is not above the lower one");
}

}  // namespace

Minimum lowest_of_scan(const FunctionOfOne& f, double low, double high, int intervals) {
  require_range(low, high);
  require(intervals > 0, "search: a scan without intervals");
  Minimum lowest{low, std::numeric_limits<double>::infinity(), false, false, intervals + 1};
  int best = -1;
  for (int k = 0; k <= intervals; ++k) {
    const double at = low + (high - low) * k / intervals;
    const double value = f(at);
    if (!(value < lowest.value)) continue;
    best = k;
    lowest.at = at;
    lowest.value = value;
  }
  if (best < 0) throw NumericalFailure("search: the function is nowhere finite");
  lowest.at_low = best == 0;
  lowest.at_high = best == intervals;
  return lowest;
}

Minimum minimum_in(const FunctionOfOne& f, double low, double high) {
  require_range(low, high);
  std::uintmax_t evaluations = kMostEvaluations;
  const auto [at, value] =
      boost::math::tools::brent_find_minima(f, low, high, kHalfOfTheDigits, evaluations);
  return {at, value, false, false, static_cast<int>(evaluations) + 1};
}

Minimum minimum_in(const FunctionOfOne& f, double low, double high, int intervals) {
  Minimum lowest = lowest_of_scan(f, low, high, intervals);
  if (lowest.at_low || lowest.at_high) return lowest;
  const double step = (high - low) / intervals;
  const auto refined = minimum_in(f, lowest.at - step, lowest.at + step);
  lowest.evaluations += refined.evaluations;
  if (refined.value < lowest.value) {
    lowest.at = refined.at;
    lowest.value = refined.value;
  }
  return lowest;
}

Minimum minimum_in(const FunctionOfOne& f, const FunctionOfOne& slope, double low, double high,
                   int intervals) {
  Minimum lowest = lowest_of_scan(f, low, high, intervals);
  if (lowest.at_low || lowest.at_high) return lowest;
  const auto counted = [&](double at) {
    ++lowest.evaluations;
    return slope(at);
  };
  const double step = (high - low) / intervals;
  const double left = lowest.at - step;
  const double right = lowest.at + step;
  if (!(counted(left) < 0.0 && counted(right) > 0.0)) return lowest;
  lowest.at = root_in(counted, left, right);
  lowest.value = f(lowest.at);
  ++lowest.evaluations;
  return lowest;
}

double root_in(const FunctionOfOne& f, double low, double high) {
  require_range(low, high);
  const double at_low = f(low);
  const double at_high = f(high);
  if (at_low == 0.0) return low;
  if (at_high == 0.0) return high;
  require((at_low < 0.0 && at_high > 0.0) || (at_low > 0.0 && at_high < 0.0),
          "search: the function has the same sign at both ends of the range, or is not a number");
  std::uintmax_t evaluations = kMostEvaluations;
  const boost::math::tools::eps_tolerance<double> to_rounding(std::numeric_limits<double>::digits -
                                                              1);
  const auto [left, right] =
      boost::math::tools::toms748_solve(f, low, high, at_low, at_high, to_rounding, evaluations);
  return 0.5 * (left + right);
}

double integral_of(const FunctionOfOne& f, double from, double to) {
  return boost::math::quadrature::gauss<double, 15>::integrate(f, from, to);
}

}  // namespace chladni
