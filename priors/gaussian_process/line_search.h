// The highest points of several functions of one variable that cost as much as one of them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace chladni::priors {

/// Values of all functions at one place.
using ValuesOnLine = std::function<Eigen::VectorXd(double)>;

struct LineMaximum {
  double at = 0.0, value = 0.0;
};
struct LineMaxima {
  std::vector<LineMaximum> maxima;  ///< one per function, at places that were evaluated
  int evaluations = 0;
};

/// A grid of `grid` places from low to high finds the hill of each function; polynomials through
/// the highest places climb it until they move by less than `tolerance`. Every evaluation serves
/// all.
[[nodiscard]] LineMaxima maxima_on_a_line(const ValuesOnLine& values, double low, double high,
                                          int grid, double tolerance);

}  // namespace chladni::priors
