// Responses averaged over bands that are wider than a model's resonances are off.
#pragma once

#include <Eigen/Core>

namespace chladni::diagnosis {

/// Bands and their comparison.
struct BandNumbers {
  /// [1] Half width of an average, of its frequency. Resonances that are off by less hardly differ.
  /// Chosen: twice what a usual model is off by.
  double half_width = 0.05;
  /// [1] Distance of two bands, of their frequency: the full width, beyond which averages are
  /// nearly independent. Chosen.
  double apart = 0.1;
  /// [1] Relative error of averages that every model has. Chosen: the usual error of a shape.
  double least_error = 0.05;
};

/// Averages along the lines, with the weights of Lorentz's curve. A response of a causal system, so
/// averaged, is the response at the complex frequency s = Δ + jω: each resonance is as wide as if
/// it had a further damping ratio of `half_width`, its residue is kept.
struct Bands {
  Eigen::VectorXd omega;    ///< B, centres [rad/s]
  Eigen::MatrixXd average;  ///< B×K, each row sums to 1
};

/// @param omega  K ascending lines [rad/s], above 0; they may be unevenly spaced
[[nodiscard]] Bands bands_of(const Eigen::VectorXd& omega, const BandNumbers& numbers = {});

/// Two averaged responses, for their distance under any real factor of the second.
class BandPair {
 public:
  /// @param measured, model  B averages [m/N]
  BandPair(const Eigen::VectorXcd& measured, const Eigen::VectorXcd& model);

  /// Mean over the bands of |measured − factor model|² over the mean square of both there and in
  /// the neighbouring bands: 0 if equal, 2 if one is far smaller, up to 4 if they are opposite.
  [[nodiscard]] double distance(double factor) const;

 private:
  Eigen::ArrayXd measured2_, model2_, along_;  // |d|², |m|², Re d m*
  Eigen::ArrayXd measured_level_, model_level_;
};

/// B ln(distance + least_error²): −ln of the density of B complex errors whose size is learned.
[[nodiscard]] double misfit_of(double distance, Eigen::Index bands,
                               const BandNumbers& numbers = {});

}  // namespace chladni::diagnosis
