// A shape as a sum of known functions with random coefficients: its evidence and the posterior
// of the coefficients.
#pragma once

#include <Eigen/Core>

namespace chladni::priors {

/// Values y at s places are W b + e, with k coefficients b ~ N(0, a² I) and noise e ~ N(0, diag
/// σ²). a² is the most likely amplitude. All other results follow in closed form from one
/// decomposition of min(s, k) rows (Rasmussen and Williams 2006, 2.7 and 5.4).
class RandomCoefficients {
 public:
  /// @param weighted  s×k: the functions at the places, times the root of their prior covariance
  /// @param values    s; @param noise  s: standard deviations
  /// Cost: s k min(s, k) and 10 min(s, k)³.
  /// @throws InvalidInput  sizes differ, a noise is not positive; NumericalFailure  no finite
  ///                       decomposition
  RandomCoefficients(const Eigen::MatrixXd& weighted, const Eigen::VectorXd& values,
                     const Eigen::VectorXd& noise);

  [[nodiscard]] double amplitude_square() const { return square_; }
  /// The most likely amplitude is practically zero: for this prior the values are noise.
  [[nodiscard]] bool vanishes() const { return vanishes_; }
  [[nodiscard]] double log_evidence() const { return log_evidence_; }

  /// Derivatives of the evidence by ln q_j, where the root of q_j scales column j; k.
  [[nodiscard]] Eigen::VectorXd variance_slopes() const;
  /// Derivatives of the evidence by the coefficients' covariance a² C; k'×k', symmetric. The change
  /// is the sum of their products with the entries of dC. @param functions  s×k':
  /// W = functions · root of C
  [[nodiscard]] Eigen::MatrixXd covariance_slopes(const Eigen::MatrixXd& functions) const;
  /// Derivatives of the evidence by ln σ; s.
  [[nodiscard]] Eigen::VectorXd noise_slopes() const;

  /// The coefficients' mean, k; cheaper than posterior().
  [[nodiscard]] Eigen::VectorXd mean() const;
  /// The coefficients' mean, k, and a root F of their covariance F Fᵀ, k×k.
  struct Posterior {
    Eigen::VectorXd mean;
    Eigen::MatrixXd root;
  };
  [[nodiscard]] Posterior posterior() const;

  /// For each place, the prediction from the other places: the error over its standard
  /// deviation, and the log density of the value (Rasmussen and Williams 5.10 to 5.12, with
  /// the same amplitude).
  struct LeftOut {
    Eigen::VectorXd standardised;
    double log_density = 0.0;
  };
  [[nodiscard]] LeftOut left_out() const;

 private:
  void decompose();
  void find_amplitude();
  [[nodiscard]] double log_evidence_at(double log_square) const;
  [[nodiscard]] double slope_at(double log_square) const;
  [[nodiscard]] Eigen::VectorXd damping() const;
  [[nodiscard]] Eigen::VectorXd inverse_diagonal() const;
  [[nodiscard]] Eigen::VectorXd solved(const Eigen::VectorXd& whitened) const;

  Eigen::MatrixXd whitened_;          // s×k, W over σ
  Eigen::VectorXd noise_, values_;    // s; values over σ
  Eigen::MatrixXd directions_;        // s×p: left singular vectors of `whitened_`
  Eigen::VectorXd strength_, along_;  // p: squared singular values; values along the directions
  double rest_ = 0.0;                 // squared length of the values' part orthogonal to them
  double square_ = 0.0, log_evidence_ = 0.0;
  bool vanishes_ = false;
};

}  // namespace chladni::priors
