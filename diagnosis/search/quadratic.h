// What a descent knows of an objective where it stands.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

namespace chladni::diagnosis {

/// Its slope and its curvature, by Gauss and Newton.
struct Quadratic {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;

  /// Levenberg's and Marquardt's: toward the minimum, the shorter the larger lambda.
  [[nodiscard]] Eigen::VectorXd step(double lambda) const {
    Eigen::MatrixXd damped = curvature;
    damped.diagonal() *= 1.0 + lambda;
    damped.diagonal().array() += 1e-300;  // of what changes nothing
    return -damped.llt().solve(gradient);
  }
  /// By how much the step lowers the objective, were it quadratic.
  [[nodiscard]] double promised(const Eigen::VectorXd& by) const {
    return -gradient.dot(by) - 0.5 * by.dot(curvature * by);
  }
  /// With the coordinates `fixed` where they are.
  [[nodiscard]] Quadratic held(const std::vector<Eigen::Index>& fixed) const {
    Quadratic result = *this;
    for (const auto i : fixed) {
      result.gradient(i) = 0.0;
      result.curvature.row(i).setZero();
      result.curvature.col(i).setZero();
      result.curvature(i, i) = 1.0;
    }
    return result;
  }
  /// A normal prior of coordinate i, which stands at x.
  void add_prior(Eigen::Index i, double x, double centre, double width) {
    const double precision = 1.0 / (width * width);
    gradient(i) += precision * (x - centre);
    curvature(i, i) += precision;
  }
};

}  // namespace chladni::diagnosis
