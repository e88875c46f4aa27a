// Maxima of several functions of one variable, for functions that one evaluation gives together.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace chladni::priors {

/// Values of all functions at one point.
using ValuesOnLine = std::function<Eigen::VectorXd(double)>;

struct LineMaximum {
  double at = 0.0, value = 0.0;
};
struct LineMaxima {
  std::vector<LineMaximum> maxima;  ///< one per function, at points that were evaluated
  int evaluations = 0;
};

/// A grid of `grid` points from low to high finds the peak of each function. Polynomials through
/// the highest points then refine it until it moves by less than `tolerance`. Every evaluation
/// serves all functions.
[[nodiscard]] LineMaxima maxima_on_a_line(const ValuesOnLine& values, double low, double high,
                                          int grid, double tolerance);

}  // namespace chladni::priors
