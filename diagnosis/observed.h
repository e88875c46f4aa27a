// Measured data in the form that a diagnosis uses.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnosis/structure.h"
#include "modal/frf_set.h"

namespace chladni::diagnosis {

/// K lines of p outputs and q inputs; response (i, j) is column i + p j.
struct Observed {
  Eigen::Index outputs = 0, inputs = 0;
  Eigen::VectorXd omega;   ///< K [rad/s], ascending, above 0
  Eigen::MatrixXcd value;  ///< K×pq [m/N]; 0 where not measured
  /// K×pq: √2/σ, σ² = E|G − G₀|², so χ² counts each part; 0: not measured. Sample variances
  /// (FrfSet::averages) are widened, so that χ² is right in the mean.
  Eigen::MatrixXd weight;

  [[nodiscard]] Eigen::Index line_count() const { return omega.size(); }
  /// Real numbers measured: two per response and line of weight above 0.
  [[nodiscard]] double number_count() const {
    return 2.0 * static_cast<double>((weight.array() > 0.0).count());
  }
  /// χ² of a zero response.
  [[nodiscard]] double power() const {
    return (value.cwiseAbs().array() * weight.array()).square().sum();
  }
};

/// Channels that both have, in the structure's order; lines above 0 Hz and at most `high_hz`.
/// @throws InvalidInput  no channel in common, fewer than 8 lines, a value whose variance is
///                       missing or not positive
struct Seen {
  Structure structure;  ///< with the measured channels only
  Observed observed;
  std::vector<std::string> notes;
};
[[nodiscard]] Seen seen(const Structure& structure, const modal::FrfSet& measured, double high_hz);

/// The same data with additional variance E|error|² of the responses, K×pq [m²/N²].
[[nodiscard]] Observed widened(const Observed& observed, const Eigen::MatrixXd& variance);

/// Variance of a model-form error of `response` times the level of each line. The level squared of
/// a response is the mean square of its row times that of its column, over that of all; where some
/// were not measured, row and column levels that give the same sums over those that were. K×pq
/// [m²/N²].
[[nodiscard]] Eigen::MatrixXd model_variance(const Observed& observed, double response);

/// About `count` lines, or all if there are fewer. Half of the density follows the length Σ|Δ
/// ln|G||, averaged over the responses, so lines are dense where the responses change; half is
/// even.
[[nodiscard]] Observed thinned(const Observed& observed, Eigen::Index count);

/// Differences of the observation from `model`, multiplied by the weights, as 2·K·pq real numbers:
/// real parts first, then imaginary parts.
[[nodiscard]] Eigen::VectorXd residual(const Observed& observed, const Eigen::MatrixXcd& model);
/// The same for a change of the model, without the change of sign: d model / dx, weighted.
[[nodiscard]] Eigen::VectorXd weighted(const Observed& observed, const Eigen::MatrixXcd& change);

}  // namespace chladni::diagnosis
