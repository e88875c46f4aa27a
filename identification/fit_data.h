// The measured data that a fit uses: receptances, each with its weight.
#pragma once

#include <Eigen/Core>

#include "modal/frf_set.h"

namespace chladni::identification {

/// K lines of p outputs and q inputs; response (i, j) is column i + p j.
struct FitData {
  Eigen::Index outputs = 0, inputs = 0;
  Eigen::VectorXd frequency_hz;  ///< K, ascending, above 0
  Eigen::MatrixXcd value;        ///< K×pq: receptances; 0 where not measured
  Eigen::MatrixXd weight;        ///< K×pq: 1/σ with σ² = E|G − G₀|²; 0: not measured
  bool noise_known = true;       ///< the weights are true deviations, not only their proportions
  bool noise_stated = true;      ///< variances came with the data, whatever was added to them
  bool freedom_known = true;   ///< else ν is not stated; the variances are weighted as exact ones
  double noise_freedom = 0.0;  ///< ν, complex degrees of freedom of each variance; 0: exact
  double shared_lines = 1.0;   ///< neighbouring lines that share one estimate of the variance
  bool weights_are_deviations = true;  ///< else they only say what counts how much: 1/|G|
  double model_error = 0.0;            ///< ε that was asked for, relative to the responses
  /// The part of the cost that the model's own error may leave: the mean of (ε |G|)² over the
  /// squared deviation. 0 where the noise is known, 1 where no variance is stated or it is of too
  /// few averages.
  double error_share = 0.0;

  [[nodiscard]] Eigen::Index line_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index response_count() const { return value.cols(); }
  /// Number of measured real numbers: two per response and line of weight above 0.
  [[nodiscard]] Eigen::Index measured_count() const { return 2 * (weight.array() > 0.0).count(); }
};

/// Norm of the deviations of all measured responses [m/N]; NaN where the weights are none.
[[nodiscard]] double noise_of(const FitData& data);

/// Mean and standard deviation of the Σ |w e|² that noise alone leaves after a fit.
struct ExpectedCost {
  double mean = 0.0, deviation = 0.0;
};

/// With exact variances, N complex numbers less P real parameters leave N − P/2; the variance is
/// the same number. A sample variance s² of ν complex degrees of freedom is independent of its
/// mean, so |n|²/s² is F-distributed with 2 and 2ν. One number then adds ν/(ν−1) with variance
/// ν²/((ν−1)(ν−2)), and one parameter takes ½ ν/(ν−2). If one s² serves W lines, its error acts on
/// all of them together; this adds W ν²/((ν−1)²(ν−2)) to the variance of each. (Pintelon and
/// Schoukens, System Identification, 2nd ed. 2012, chapters 10 and 12: sample maximum likelihood,
/// which also has the first and the loss of efficiency (ν−1)/(ν−2).)
/// Where the noise is not known the weights count as exact.
[[nodiscard]] ExpectedCost expected_cost(const FitData& data, Eigen::Index parameters);

/// The cost, divided by the cost that noise alone leaves with so many fitted parameters. This is
/// the error factor of the squared deviations in the weights. Where the noise is known the result
/// is 1 up to five deviations of the expected cost, because such a difference can be chance. Else
/// it is the ratio itself, above 0.
[[nodiscard]] double noise_level(const FitData& data, double cost, Eigen::Index parameters = 0);

/// Variance of the result of a fit with these weights, divided by (2 JᵀJ)⁻¹: ν/(ν−2), and 1
/// where variances are exact. (Divided by the Cramér-Rao bound it is (ν−1)/(ν−2): scattered
/// weights cost efficiency.)
[[nodiscard]] double variance_factor(const FitData& data);

/// The source of the weights.
enum class Weighting {
  variance,           ///< 1/σ: maximum likelihood
  inverse_magnitude,  ///< 1/|G| between two limits, the thesis' (4.2, step 1)
};

struct FitDataOptions {
  double low_hz = 0.0, high_hz = 0.0;  ///< the band; high 0: all lines
  Weighting weighting = Weighting::variance;
  double model_error = 0.0;  ///< ε: σ² + (ε |G|)², |G| smoothed over neighbouring lines
  double cut_off_db = 40.0;  ///< for inverse_magnitude: limit below the largest |G| of all
  /// For inverse_magnitude as well: the weights are not smaller than 1/|G| this far below the
  /// response's own largest |G|, so that resonances weigh more (thesis 5.2.4; it does not state how
  /// far). 0: not clipped.
  double clip_db = 0.0;
};

/// Converts the set to weighted receptances. Variances of 2 or fewer degrees of freedom
/// (FrfSet::averages) count as proportions only, because their inverse has no mean square. Where ν
/// is not stated, freedom_known is false: noise then leaves anything up to good_level. The
/// number of lines that share a variance follows from the differences between neighbours. If the
/// set states no variance, each line's variance is estimated from its difference to a local
/// polynomial through its neighbours. Within 12 lines of a resonance of few lines this is too
/// large: twice the true one if the peak is 40 dB above the noise, thousands of times if it is 80
/// dB. It serves for a first fit, after which `reweighted` gives the true one. Where others have a
/// variance, a variance of 0 is none: values of 0 beside it were not measured, and other values
/// take the variance of their neighbours.
/// @throws InvalidInput  fewer than 9 lines in the band, a response measured on 1 to 8 lines, one
///                       whose receptances are all below 1e-70 m/N or not all below 1e70 m/N, a
///                       variance that is negative, or 0 on all lines of a measured response where
///                       others have one
[[nodiscard]] FitData fit_data(const modal::FrfSet& set, const FitDataOptions& options = {});

/// The same data with new variances. They come from local polynomials through the residual of a
/// fit, not through the data: a resonance only a few lines wide must not count as noise. For sets
/// that state no variance.
/// @param fitted  K×pq
[[nodiscard]] FitData reweighted(const FitData& data, const Eigen::MatrixXcd& fitted,
                                 const FitDataOptions& options);

}  // namespace chladni::identification
