// Random numbers that are the same on every machine: std::normal_distribution is not.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

namespace chladni {

/// A random sequence that depends on the seed only. Two draws in one expression have no defined
/// order, so store each draw in a variable.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}

  /// A uniform number in (0, 1).
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  /// A normal number with mean 0 and variance 1 (Box and Muller 1958).
  double normal() {
    const double length = std::sqrt(-2.0 * std::log(uniform()));
    return length * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937 random_;
};

}  // namespace chladni
