// The lowest point of a smooth function in a box. (NLopt stands behind it.)
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace chladni::priors {

/// The value at a point; sets the gradient, of the same size. May throw NumericalFailure.
using Objective = std::function<double(const Eigen::VectorXd& at, Eigen::VectorXd& gradient)>;

struct Optimum {
  Eigen::VectorXd at;
  double value = 0.0;
  int evaluations = 0;
  bool converged = false;      ///< within the tolerance, not stopped by the count
  std::vector<bool> at_bound;  ///< per coordinate
};

struct OptimumOptions {
  double tolerance = 1e-5;  ///< of each coordinate, absolute
  int evaluations = 200;    ///< at most
};

/// The local minimum that limited-memory BFGS (Nocedal 1980; NLopt's LD_LBFGS) finds from `start`.
/// @throws InvalidInput  sizes differ, a bound is on the wrong side of the other
[[nodiscard]] Optimum minimum(const Objective& objective, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                              const OptimumOptions& options = {});

}  // namespace chladni::priors
