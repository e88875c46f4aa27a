// Local quadratic model of an objective for a descent.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

namespace chladni::diagnosis {

/// Gradient and curvature of the objective, by Gauss and Newton.
struct Quadratic {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;

  /// Step of Levenberg and Marquardt toward the minimum; shorter for larger lambda.
  [[nodiscard]] Eigen::VectorXd step(double lambda) const {
    Eigen::MatrixXd damped = curvature;
    damped.diagonal() *= 1.0 + lambda;
    damped.diagonal().array() += 1e-300;  // for coordinates that change nothing
    return -damped.llt().solve(gradient);
  }
  /// Fall of the objective by the step, if it were quadratic.
  [[nodiscard]] double promised(const Eigen::VectorXd& by) const {
    return -gradient.dot(by) - 0.5 * by.dot(curvature * by);
  }
  /// The same model with the coordinates `fixed` held.
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
  /// Adds a normal prior of coordinate i, whose value is x.
  void add_prior(Eigen::Index i, double x, double centre, double width) {
    const double precision = 1.0 / (width * width);
    gradient(i) += precision * (x - centre);
    curvature(i, i) += precision;
  }
};

/// A normal density that is cut.
struct Cut {
  double distance = 0.0;   ///< from the mode to the end; or 0
  double slope = 0.0;      ///< at the end, where the mode lies beyond it: of −ln of the density
  double deviation = 1.0;  ///< without the cut
};

/// ln of the part of the integral that is left: ∫ exp(−slope u − ½ (u / deviation)²) du over
/// u > −distance, over that of slope 0 over all u. One of slope and distance is 0.
[[nodiscard]] inline double log_part_before_an_end(const Cut& cut) {
  constexpr double kEnough = 20.0;  // from here on exp(x²) erfc(x) by its series
  if (cut.slope == 0.0) {
    return std::log1p(-0.5 * std::erfc(cut.distance / cut.deviation / std::numbers::sqrt2));
  }
  const double x = cut.slope * cut.deviation / std::numbers::sqrt2;
  if (x < kEnough) return x * x + std::log(0.5 * std::erfc(x));
  return std::log(0.5 * std::numbers::inv_sqrtpi / x) - 0.5 / (x * x);
}

}  // namespace chladni::diagnosis
