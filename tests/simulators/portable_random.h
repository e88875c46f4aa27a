// Random numbers that are the same with every standard library: std::mt19937 is specified to the
// bit, std::normal_distribution is not.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

namespace chladni::simulators {

class Dice {
 public:
  explicit Dice(unsigned seed) : generator_(seed) {}

  /// A uniform number in (0, 1) with 53 bits.
  double uniform() {
    const auto high = static_cast<double>(generator_() >> 5U);
    const auto low = static_cast<double>(generator_() >> 6U);
    return (high * 67108864.0 + low + 0.5) / 9007199254740992.0;
  }
  double between(double low, double high) { return low + (high - low) * uniform(); }

  /// A standard normal number (Box and Muller, 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// A number of Student's t of four degrees of freedom: variance 2, one in 90 beyond 3.7.
  double student() {
    const double above = normal();
    const double squares = -2.0 * std::log(uniform() * uniform());  // χ² of four
    return above / std::sqrt(0.25 * squares);
  }
  Eigen::MatrixXd normal(Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd values(rows, cols);
    for (double& value : values.reshaped()) value = normal();
    return values;
  }

  /// A whole number from 0 to bound − 1.
  Eigen::Index below(Eigen::Index bound) {
    return static_cast<Eigen::Index>(uniform() * static_cast<double>(bound));
  }

 private:
  std::mt19937 generator_;
};

}  // namespace chladni::simulators
