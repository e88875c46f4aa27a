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

  [[nodiscard]] Eigen::Index line_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index response_count() const { return value.cols(); }
  /// Real numbers that were measured: two per response and line of weight above 0.
  [[nodiscard]] Eigen::Index measured_count() const { return 2 * (weight.array() > 0.0).count(); }
};

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

/// As receptances, weighted. Variances that the set does not state are estimated from how much each
/// line differs from a local polynomial through its neighbours.
/// @throws InvalidInput  fewer than 9 lines in the band, a response with 1 to 8 finite lines, a
///                       variance that is negative
[[nodiscard]] FitData fit_data(const modal::FrfSet& set, const FitDataOptions& options = {});

/// The same data with variances estimated from how much what a fit leaves, instead of the data,
/// differs from local polynomials: a resonance as narrow as a few lines is no noise. For sets
/// that state no variance.
/// @param fitted  K×pq
[[nodiscard]] FitData reweighted(const FitData& data, const Eigen::MatrixXcd& fitted,
                                 const FitDataOptions& options);

}  // namespace chladni::identification
