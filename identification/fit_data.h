// What a fit sees of the measurement: receptances, each with its weight.
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
  double noise_freedom = 0.0;  ///< ν, complex degrees of freedom of each variance; 0: it is exact
  double shared_lines = 1.0;   ///< neighbouring lines of which one estimate is the variance

  [[nodiscard]] Eigen::Index line_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index response_count() const { return value.cols(); }
  /// Real numbers that were measured: two per response and line of weight above 0.
  [[nodiscard]] Eigen::Index measured_count() const { return 2 * (weight.array() > 0.0).count(); }
};

/// Σ |w e|² of what noise leaves of a fit: its mean and standard deviation.
struct ExpectedCost {
  double mean = 0.0, deviation = 0.0;
};

/// With exact variances N complex numbers less P real parameters leave N − P/2, of that variance.
/// A sample variance s² of ν complex degrees of freedom is independent of the mean that it belongs
/// to, so that |n|²/s² is F-distributed with 2 and 2ν: a number adds ν/(ν−1), of variance
/// ν²/((ν−1)(ν−2)), and a parameter takes ½ ν/(ν−2). One s² that stands for W lines errs on all of
/// them together, which adds W ν²/((ν−1)²(ν−2)) to the variance of each. (Pintelon and Schoukens,
/// System Identification, 2nd ed. 2012, chapters 10 and 12: sample maximum likelihood, which also
/// has the first and the loss of efficiency (ν−1)/(ν−2).)
/// Where the noise is not known the weights count as exact.
[[nodiscard]] ExpectedCost expected_cost(const FitData& data, Eigen::Index parameters);

/// What a cost is of that which noise alone leaves with so many parameters fitted: the factor by
/// which squares of the weights' deviations are off. Where the noise is known it is 1 up to five
/// deviations of the expected cost, since nothing but chance leaves less or more than noise; else
/// whatever it is, above 0.
[[nodiscard]] double noise_level(const FitData& data, double cost, Eigen::Index parameters = 0);

/// Variance of what a fit with these weights finds over (2 JᵀJ)⁻¹: ν/(ν−2), 1 where variances are
/// exact. (Of the Cramér-Rao bound that is (ν−1)/(ν−2): weights that scatter cost efficiency.)
[[nodiscard]] double variance_factor(const FitData& data);

/// How the weights come about.
enum class Weighting {
  variance,           ///< 1/σ: maximum likelihood
  inverse_magnitude,  ///< 1/|G| between two limits, the thesis' (4.2, step 1)
};

struct FitDataOptions {
  double low_hz = 0.0, high_hz = 0.0;  ///< the band; high 0: all lines
  Weighting weighting = Weighting::variance;
  double model_error = 0.0;  ///< ε: σ² + (ε |G|)², |G| smoothed over neighbouring lines
  double cut_off_db = 40.0;  ///< of inverse_magnitude: below the largest |G| of all responses
  /// Likewise: minima of the weights are clipped at 1/|G| this far below the response's own
  /// largest, so that resonances weigh more (thesis 5.2.4; it does not state how far). 0: not
  /// clipped.
  double clip_db = 0.0;
};

/// As receptances, weighted. Variances of 2 or fewer degrees of freedom (FrfSet::averages) are
/// taken for proportions: their inverse has no mean square. How many lines share a variance is told
/// by how little neighbours differ. Variances that the set does not state are estimated from how
/// much each line differs from a local polynomial through its neighbours.
/// @throws InvalidInput  fewer than 9 lines in the band, a response with 1 to 8 finite lines, one
///                       whose receptances are all below 1e-70 m/N or not all below 1e70 m/N, a
///                       variance that is negative
[[nodiscard]] FitData fit_data(const modal::FrfSet& set, const FitDataOptions& options = {});

/// The same data with variances estimated from how much what a fit leaves, instead of the data,
/// differs from local polynomials: a resonance as narrow as a few lines is no noise. For sets
/// that state no variance.
/// @param fitted  K×pq
[[nodiscard]] FitData reweighted(const FitData& data, const Eigen::MatrixXcd& fitted,
                                 const FitDataOptions& options);

}  // namespace chladni::identification
