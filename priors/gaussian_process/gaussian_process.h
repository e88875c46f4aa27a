// Gaussian-process regression: exact likelihoods, leave-one-out and predictions from one factor.
#pragma once

#include "priors/gaussian_process/trend.h"
#include "priors/kernel.h"

namespace chladni::priors {

/// f ~ GP(Hβ, a² k); with a trend β is free (universal kriging: β integrated out).
struct GaussianPrior {
  Kernel kernel;
  Eigen::VectorXd parameters;  ///< of the kernel
  double amplitude = 1.0;      ///< a, in the unit of the values
  Trend trend;
};

/// The merit that chooses hyper-parameters.
enum class Merit {
  marginal_likelihood,  ///< ln p(y); with a trend, of the contrasts without the trend (REML)
  leave_one_out,        ///< Σ_i ln p(y_i | all others)
};

/// One entry per output. m shapes share C = a² K + N; each may have its own factor b²: b² C.
struct Score {
  Eigen::VectorXd value;   ///< m: natural logarithm
  Eigen::VectorXd factor;  ///< m: b; the best one in closed form, or 1
};

/// Derivatives of a score, per output.
struct Slopes {
  Eigen::MatrixXd parameters;  ///< p×m: by ln θ_k
  Eigen::VectorXd amplitude;   ///< m: by ln a
  Eigen::VectorXd noise;       ///< m: by ln of a factor common to all noise variances
};

struct Prediction {
  Eigen::MatrixXd mean;       ///< n×m
  Eigen::VectorXd deviation;  ///< n: of the function, without noise; times `factor` of an output
};

struct LeaveOneOut {
  Eigen::MatrixXd mean;      ///< N×m: prediction of each value from all others
  Eigen::VectorXd variance;  ///< N: of the value, including its noise
};

/// A prior and the places of its N values, factorised once for all outputs.
class GaussianProcess {
 public:
  /// Cost N³ / 3. A matrix that is singular to working precision gets a jitter on its diagonal,
  /// which jitter() returns. A long length scale never causes an exception.
  /// @param noise_variance  N, 0 or more
  /// @throws InvalidInput      sizes that do not fit, a trend of more functions than values
  /// @throws NumericalFailure  not positive definite even with a jitter of 1e-4 of the mean
  ///                           diagonal
  GaussianProcess(GaussianPrior prior, const Points& points, const Eigen::VectorXd& noise_variance);

  [[nodiscard]] const GaussianPrior& prior() const { return prior_; }
  [[nodiscard]] Eigen::Index point_count() const { return points_.rows(); }
  /// Variance that was added to every value for the factorisation; 0: none.
  [[nodiscard]] double jitter() const { return jitter_; }

  /// @param values  N×m; with `best_factor` each output gets its own b
  [[nodiscard]] Score score(Merit merit, const Eigen::MatrixXd& values,
                            bool best_factor = false) const;
  /// Exact derivatives of that score at the given factors. At the best factors they are the
  /// gradient of the profile. Cost 2N³ / 3, and the same again per output for leave-one-out.
  [[nodiscard]] Slopes slopes(Merit merit, const Eigen::MatrixXd& values,
                              const Eigen::VectorXd& factor) const;
  /// In closed form (Dubrule 1983); the cost is that of `slopes`.
  [[nodiscard]] LeaveOneOut leave_one_out(const Eigen::MatrixXd& values) const;
  /// Prediction at n places; cost n N² in blocks of bounded memory.
  [[nodiscard]] Prediction at(const Points& places, const Eigen::MatrixXd& values) const;
  /// Matrix that gives the prediction's mean from the values: n×N.
  [[nodiscard]] Eigen::MatrixXd weights(const Points& places) const;

 private:
  // P = C⁻¹ − C⁻¹H (HᵀC⁻¹H)⁻¹ HᵀC⁻¹: the inverse without the trend.
  [[nodiscard]] Eigen::MatrixXd projected(const Eigen::MatrixXd& values) const;  // P y
  [[nodiscard]] Eigen::MatrixXd projected_inverse() const;                       // P, lower
  [[nodiscard]] double log_determinant() const;
  void factorise();
  void require_values(const Eigen::MatrixXd& values) const;
  [[nodiscard]] Slopes likelihood_slopes(const Eigen::MatrixXd& values,
                                         const Eigen::VectorXd& factor) const;
  [[nodiscard]] Slopes leave_one_out_slopes(const Eigen::MatrixXd& values,
                                            const Eigen::VectorXd& factor) const;

  GaussianPrior prior_;
  Points points_;
  Eigen::VectorXd noise_;  // N, with the jitter
  double jitter_ = 0.0;
  Eigen::MatrixXd factor_;             // L of C, lower
  Eigen::MatrixXd trend_;              // H, N×q
  Eigen::MatrixXd trend_solved_;       // C⁻¹H
  Eigen::MatrixXd gram_factor_;        // L of HᵀC⁻¹H
  double gram_log_determinant_ = 0.0;  // ln |HᵀC⁻¹H| − ln |HᵀH|
};

/// The a that maximises the marginal likelihood of N values under a² K + diag(noise_variance) with
/// a free trend. The search is one-dimensional, in the eigenbasis. Cost about 9N³.
/// @param covariance      lower triangle of K (amplitude 1)
/// @param noise_variance  N, positive
[[nodiscard]] double best_amplitude(const Eigen::MatrixXd& covariance,
                                    const Eigen::VectorXd& noise_variance,
                                    const Eigen::MatrixXd& trend, const Eigen::VectorXd& values);

}  // namespace chladni::priors
