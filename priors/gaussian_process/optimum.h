// Local minimum of a smooth function in a box, by NLopt.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace chladni::priors {

/// Returns the value at a point and sets the gradient, of the same size. May
/// throw NumericalFailure.
using Objective = std::function<double(const Eigen::VectorXd& at, Eigen::VectorXd& gradient)>;

struct Optimum {
  Eigen::VectorXd at;
  double value = 0.0;
  int evaluations = 0;
  bool converged = false;      ///< to the tolerance, not stopped by the number of evaluations
  std::vector<bool> at_bound;  ///< per coordinate
};

struct OptimumOptions {
  double tolerance = 1e-5;  ///< of each coordinate, absolute
  int evaluations = 200;    ///< at most
};

/// The local minimum that limited-memory BFGS finds from `start` (Nocedal 1980; NLopt's LD_LBFGS).
/// @throws InvalidInput  sizes differ, or the start is not between the bounds
[[nodiscard]] Optimum minimum(const Objective& objective, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                              const OptimumOptions& options = {});

}  // namespace chladni::priors
