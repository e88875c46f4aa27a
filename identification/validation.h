// What a fit leaves of its data, band by band.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/fit_data.h"

namespace chladni::identification {

/// The residual e = G − Ĝ on the lines about one mode, over all responses.
struct BandResidual {
  double low_hz = 0.0, high_hz = 0.0;  ///< first and last line
  Eigen::Index lines = 0;
  double relative_error = 0.0;   ///< |e| over |G|
  double relative_noise = 0.0;   ///< its stated deviation, likewise
  double level = 0.0;            ///< mean |e|² over its stated variance: 1 where noise is left
  double level_deviation = 0.0;  ///< of `level`, if noise alone is left
  /// Re Σ conj(e_k) e_{k+1} over Σ |e_k|², e over its deviation: 0 for noise, towards 1 where the
  /// model lacks something that neighbouring lines share.
  double correlation = 0.0;
  double correlation_limit = 0.0;  ///< what |correlation| of noise exceeds once in twenty
};

struct Validation {
  /// 100 (1 − |e| / |G − its mean|), norms over all lines of a response: "fit" of MATLAB's compare.
  /// p×q; NaN where nothing was measured.
  Eigen::MatrixXd fit_percent_of;
  double fit_percent = 0.0;  ///< with the norms over all responses together
  BandResidual whole;
  std::vector<BandResidual> bands;  ///< ascending; every line is in one
};

/// Bands end between neighbouring modes, at the geometric mean of their frequencies; modes with
/// fewer than 8 lines between them share one.
/// @param fitted        K×pq
/// @param frequency_hz  of the modes that are not rigid, ascending
/// Cost: K p q.
[[nodiscard]] Validation validation(const FitData& data, const Eigen::MatrixXcd& fitted,
                                    const Eigen::VectorXd& frequency_hz);

/// Singular values of the matrix of responses at each line, K×min(p, q), descending: as many are
/// large as modes take part there (complex mode indicator function). NaN on lines where a response
/// was not measured. Source: C. Y. Shih et al., Mech. Syst. Signal Process. 2 (1988) 367.
[[nodiscard]] Eigen::MatrixXd mode_indicator(const FitData& data);

}  // namespace chladni::identification
