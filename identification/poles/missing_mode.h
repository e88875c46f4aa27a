// The mode that would explain most of what a fit leaves.
#pragma once

#include <complex>

#include "identification/modal_fit.h"

namespace chladni::identification {

struct MissingMode {
  std::complex<double> pole;  ///< [rad/s]
  double gain = 0.0;          ///< by which it would lower Σ |w error|², the others held still
};

/// Scans natural frequencies over the band, a third of a bandwidth apart, and damping ratios from a
/// quarter to four times those of the fit (0.001 to 0.05 where it has none).
/// Cost: pq times the lines within 8 bandwidths of each candidate.
[[nodiscard]] MissingMode missing_mode(const FitData& data, const ModalFit& fit);

}  // namespace chladni::identification
