// What a diagnosis sees of the measurement.
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
  Eigen::MatrixXd weight;  ///< K×pq: √2/σ, σ² = E|G − G₀|², so that χ² counts each part; 0: none

  [[nodiscard]] Eigen::Index line_count() const { return omega.size(); }
  /// Real numbers measured: two per response and line of weight above 0.
  [[nodiscard]] double number_count() const {
    return 2.0 * static_cast<double>((weight.array() > 0.0).count());
  }
  /// χ² of no response at all.
  [[nodiscard]] double power() const {
    return (value.cwiseAbs().array() * weight.array()).square().sum();
  }
};

/// Channels of both, in the order of the structure; lines above 0 Hz and at most `high_hz`.
/// @throws InvalidInput  no channel in common, fewer than 8 lines, a variance that is missing where
///                       a value is, or not positive
struct Seen {
  Structure structure;  ///< its channels those that are measured
  Observed observed;
  std::vector<std::string> notes;
};
[[nodiscard]] Seen seen(const Structure& structure, const modal::FrfSet& measured, double high_hz);

/// With more variance E|error|² in its responses, K×pq [m²/N²].
[[nodiscard]] Observed widened(const Observed& observed, const Eigen::MatrixXd& variance);

/// Of a model that is wrong by `response` times the level of each line: of a response the mean
/// squares of its row and of its column, over that of all. K×pq [m²/N²].
[[nodiscard]] Eigen::MatrixXd model_variance(const Observed& observed, double response);

/// About `count` lines, dense where the responses turn (evenly along the length of the curves
/// ln|G| over ln f, averaged over the responses); all where there are fewer.
[[nodiscard]] Observed thinned(const Observed& observed, Eigen::Index count);

/// √weight-ed differences of `model` from what was observed, as 2·K·pq real numbers: real parts
/// first, then imaginary ones.
[[nodiscard]] Eigen::VectorXd residual(const Observed& observed, const Eigen::MatrixXcd& model);
/// The same of a change of the model, without the sign turned: d model / dx weighted.
[[nodiscard]] Eigen::VectorXd weighted(const Observed& observed, const Eigen::MatrixXcd& change);

}  // namespace chladni::diagnosis
