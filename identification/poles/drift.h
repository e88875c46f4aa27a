// Resonances that differ in frequency between responses. The structure changed between the
// measurements, by temperature or by masses attached to it. If the resonances are narrow, this must
// not be mistaken for further modes.
#pragma once

#include <Eigen/Core>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Response e is G_e(f / (1 + shift_e)) of one structure.
struct Drift {
  Eigen::VectorXd shift;      ///< pq, relative; their mean, weighted by information, is 0
  Eigen::VectorXd deviation;  ///< pq: of each shift
  double change = 0.0;        ///< relative change of the responses by the shifts: rms of all
  double excess = 0.0;        ///< rms of the shifts over their deviations, of measured responses

  /// Whether fits would take the drift for modes: it changes the responses by more than 5 %, and
  /// the shifts are above five deviations.
  [[nodiscard]] bool matters() const;
};

/// Fits from `start` and, in turns, finds the shifts by linear regression on the residual. Each
/// shift is shrunk by its own variance relative to that of all shifts.
/// Cost: some four fits of the start.
/// @throws InvalidInput  as modal_fit
struct DriftFit {
  Drift drift;
  ModalFit fit;  ///< of the data without drift
};
[[nodiscard]] DriftFit drift_fit(const FitData& data, const Start& start,
                                 const FitOptions& options);

/// The data as if all responses had been measured at once: G_e + Ĝ_e(f) − Ĝ_e(f / (1 + shift_e)).
/// @param shift  pq
[[nodiscard]] FitData without_drift(const FitData& data, const ModalFit& fit,
                                    const Eigen::VectorXd& shift);

}  // namespace chladni::identification
