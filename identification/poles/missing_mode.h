// The further mode that explains most of the residual of a fit.
#pragma once

#include <complex>

#include "identification/modal_fit.h"

namespace chladni::identification {

struct MissingMode {
  std::complex<double> pole;  ///< [rad/s]
  Eigen::MatrixXcd general;  ///< p×q: X of X/(s − p) and its conjugate, where shapes are complex
  double gain = 0.0;          ///< decrease of Σ |w error|² with the other modes fixed
};

/// Scans natural frequencies over the band, a third of a bandwidth apart, and damping ratios from a
/// quarter of the least to four times the largest of the fit (0.001 to 0.05 if the fit has none).
/// Cost: pq times the lines within 8 bandwidths of each candidate.
[[nodiscard]] MissingMode missing_mode(const FitData& data, const ModalFit& fit);

}  // namespace chladni::identification
