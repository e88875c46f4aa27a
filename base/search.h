// Minima, roots and integrals of a function of one variable.
#pragma once

#include <functional>

namespace chladni {

/// f(x), or f′(x). x and f have the units of the caller.
using FunctionOfOne = std::function<double(double)>;

struct Minimum {
  double at = 0.0, value = 0.0;
  /// The lowest scanned point is an end of the range: the minimum may lie beyond it.
  bool at_low = false, at_high = false;
  int evaluations = 0;  ///< of f and of its slope
};

/// The lowest of intervals + 1 evenly spaced points; of equal ones the first.
/// @throws InvalidInput  high is not above low, or there are no intervals; NumericalFailure  f is
///                       nowhere finite
[[nodiscard]] Minimum lowest_of_scan(const FunctionOfOne& f, double low, double high,
                                     int intervals);

/// A local minimum between low and high, the only one of a function with one valley. Parabolas and
/// golden sections find it to 3e-8 of |at| or better; rounding of f permits no more.
/// Cost: 10 to 40 evaluations. Source: R. P. Brent, Algorithms for Minimization without
/// Derivatives, 1973, ch. 5. @throws InvalidInput  high is not above low
[[nodiscard]] Minimum minimum_in(const FunctionOfOne& f, double low, double high);

/// The minimum of a function with several valleys: `lowest_of_scan`, then `minimum_in` between the
/// neighbours of its lowest point. An end of the range is the answer if it is the lowest point.
[[nodiscard]] Minimum minimum_in(const FunctionOfOne& f, double low, double high, int intervals);

/// The same with the slope of f: the root of the slope is exact to rounding. Where the slope has
/// one sign between the neighbours of the lowest point, that point is the answer.
[[nodiscard]] Minimum minimum_in(const FunctionOfOne& f, const FunctionOfOne& slope, double low,
                                 double high, int intervals);

/// A root between low and high, where f has different signs; to 4e-16 of its size.
/// Cost: 5 to 20 evaluations, more for a root at 0. Source: G. E. Alefeld, F. A. Potra, Y. Shi,
/// ACM Trans. Math. Softw. 21 (1995) 327, Algorithm 748.
/// @throws InvalidInput  high is not above low, or f has the same sign at both ends or is NaN
[[nodiscard]] double root_in(const FunctionOfOne& f, double low, double high);

/// ∫ f from `from` to `to` by Gauss's rule of 15 points, which is exact for polynomials of degree
/// 29; for functions without kinks between the ends.
[[nodiscard]] double integral_of(const FunctionOfOne& f, double from, double to);

}  // namespace chladni
