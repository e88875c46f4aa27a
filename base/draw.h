// Random numbers that are the same on every machine: std::normal_distribution is not.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

namespace chladni {

/// A sequence that its seed determines. Two draws in one expression have no defined order: name
/// them.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}

  /// In (0, 1).
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  /// Of mean 0 and variance 1 (Box and Muller 1958).
  double normal() {
    const double length = std::sqrt(-2.0 * std::log(uniform()));
    return length * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937 random_;
};

}  // namespace chladni
