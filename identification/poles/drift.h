// Resonances that lie elsewhere in other responses: the structure changed between the measurements,
// by its temperature or by what hung on it. Where they are narrow that is not to be confused with
// further modes.
#pragma once

#include <Eigen/Core>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Response e is G_e(f / (1 + shift_e)) of one structure.
struct Drift {
  Eigen::VectorXd shift;      ///< pq, relative; their mean, weighted by information, is 0
  Eigen::VectorXd deviation;  ///< pq: of each
  double change = 0.0;  ///< what the shifts change of the responses, over their size: rms of all
  double excess = 0.0;  ///< rms of the shifts over their deviations

  /// Whether fits would take it for modes: 5 % of the responses, and more than the deviations say.
  [[nodiscard]] bool matters() const;
};

/// Fits from `start` and shifts by linear regression of what they leave, in turns; each shift is
/// shrunk by its own variance over that of all.
/// Cost: some four fits of the start.
/// @throws InvalidInput  as modal_fit
struct DriftFit {
  Drift drift;
  ModalFit fit;  ///< of the data without it
};
[[nodiscard]] DriftFit drift_fit(const FitData& data, const Start& start,
                                 const FitOptions& options);

/// The data as if all had been measured at once: G_e + Ĝ_e(f) − Ĝ_e(f / (1 + shift_e)).
/// @param shift  pq
[[nodiscard]] FitData without_drift(const FitData& data, const ModalFit& fit,
                                    const Eigen::VectorXd& shift);

}  // namespace chladni::identification
