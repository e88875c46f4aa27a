// Smooth functions through noisy values, with a free part that is not penalised: general splines.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::priors {

/// The choice of the smoothing λ. There are n values and n − p contrasts beyond the free part.
enum class SmoothingRule {
  reml_known_noise,              ///< likelihood of the contrasts, with the stated noise
  reml,                          ///< the same with learned noise
  generalised_cross_validation,  ///< Σ c_m ε_m², c_m = ((1 − A_mm) / (1 − tr A / n))²
  leave_one_out,                 ///< Σ ε_m², ε_m the error at m of the fit without value m
};

struct Smoothing {
  double lambda = 0.0;          ///< infinite: only the free part
  double noise = 1.0;           ///< for a value of relative deviation 1: stated or learned
  double log_likelihood = 0.0;  ///< of the contrasts, at this λ and noise
  bool interpolates = false;    ///< λ is at its lower bound
};

/// f = Σ_l c_l k(x, x_l) + t(x)ᵀ d.
struct SmoothFunction {
  Eigen::VectorXd weights;  ///< c, n
  Eigen::VectorXd trend;    ///< d, p
};

/// Minimises Σ ((y_m − f(x_m)) / ν_m)² + λ cᵀ K c over the functions above with Tᵀ c = 0. This
/// equals the posterior mean if f is t(x)ᵀ d, with unknown d, plus a Gaussian process of covariance
/// (σ²/λ) k, and the noise of y_m is σ ν_m (Wahba 1978). One QR of T and one eigen-decomposition of
/// the projected K serve every λ, rule and set of values: with the n − p contrasts z and
/// h_k = λ / (e_k + λ), all results are sums over k (Demmler and Reinsch 1975).
class Smoother {
 public:
  /// @param kernel     n×n, k(x_l, x_m); positive semidefinite on vectors with Tᵀ c = 0
  /// @param trend      n×p, rank p: t at the places
  /// @param deviation  n: ν > 0
  /// Cost: 10 n³. @throws InvalidInput  sizes differ, ν not positive, T of a lower rank
  /// @throws NumericalFailure  the kernel is not positive semidefinite there
  Smoother(const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& trend,
           const Eigen::VectorXd& deviation);

  [[nodiscard]] Eigen::Index contrast_count() const { return eigenvalue_.size(); }

  /// The criterion of the rule and its derivative by ln λ. For REML: minus the log likelihood.
  struct Criterion {
    double value = 0.0, slope = 0.0;
  };
  [[nodiscard]] Criterion criterion(const Eigen::VectorXd& values, SmoothingRule rule, double noise,
                                    double lambda) const;

  /// The minimum of the criterion: the best of a grid of 8 per decade, then the root of its slope.
  /// @param noise  stated σ. `reml` learns its own, σ² = Σ z² h / (n − p). The cross-validations
  /// take Σ z² h² / Σ h (Wahba 1983), but at least the stated noise: it would vanish if they follow
  /// the values too closely. One contrast tells its size and not how much of it is noise; there,
  /// and where no value is foretold by the others, each rule is `reml_known_noise`.
  /// Cost: n² for each of some 250 points.
  [[nodiscard]] Smoothing chosen(const Eigen::VectorXd& values, SmoothingRule rule,
                                 double noise) const;

  /// A given λ, with the stated σ.
  [[nodiscard]] Smoothing given(const Eigen::VectorXd& values, double lambda, double noise) const;

  [[nodiscard]] SmoothFunction fit(const Eigen::VectorXd& values, double lambda) const;

  /// y_m less the prediction of the fit without m; n. NaN where the other values do not
  /// determine the free part.
  [[nodiscard]] Eigen::VectorXd left_out_errors(const Eigen::VectorXd& values, double lambda) const;
  /// A_mm = ∂f(x_m)/∂y_m; n.
  [[nodiscard]] Eigen::VectorXd influence(double lambda) const;

  /// Posterior variances of f at N points.
  /// @param kernel  N×n, k(x, x_l); @param self  N, k(x, x); @param trend  N×p
  /// @returns N×m, for each of the m smoothings. Cost: N n (n + m).
  [[nodiscard]] Eigen::MatrixXd variance(const Eigen::MatrixXd& kernel, const Eigen::VectorXd& self,
                                         const Eigen::MatrixXd& trend,
                                         const std::vector<Smoothing>& smoothings) const;

 private:
  struct Lowest {
    double lambda = 0.0;
    bool at_lower_bound = false;
  };
  [[nodiscard]] Lowest lowest(const Eigen::VectorXd& values, SmoothingRule rule, double noise,
                              double loudness) const;
  void decompose(const Eigen::MatrixXd& rest);
  [[nodiscard]] Eigen::ArrayXd contrasts(const Eigen::VectorXd& values) const;
  [[nodiscard]] Eigen::ArrayXd shrinkage(double lambda) const;
  [[nodiscard]] Criterion cross_validation(const Eigen::ArrayXd& z, const Eigen::ArrayXd& h) const;

  Eigen::VectorXd deviation_;     // n
  Eigen::MatrixXd scaled_;        // n×n: K over ν on both sides
  Eigen::MatrixXd free_;          // n×p: Q of T over ν
  Eigen::MatrixXd triangle_;      // p×p: its R
  Eigen::MatrixXd directions_;    // n×(n−p): orthonormal to the free part, diagonalise K
  Eigen::VectorXd eigenvalue_;    // n−p, 0 or more
  Eigen::ArrayX<bool> foretold_;  // n: the others tell the value, they determine the free part
};

}  // namespace chladni::priors
