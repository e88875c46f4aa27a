// Frequency responses of a structure that a loop holds: the indirect three-point approach (thesis
// (4.3), (4.4); van den Hof 1998; Pintelon and Schoukens 2012, section 2.6).
#pragma once

#include "identification/frf_estimate.h"

namespace chladni::identification {

struct ClosedLoopEstimate {
  FrfEstimate estimate;                       ///< of the structure, from commands to outputs
  Eigen::VectorXd condition;                  ///< per line, of the input sensitivity S
  std::vector<Eigen::MatrixXcd> sensitivity;  ///< [k], q×q: S, from references to inputs
};

/// P from the references to the outputs and S from the references to the inputs, both averaged over
/// periods and realisations before G = P S⁻¹ by the matrix inverse on each line. Rows of S of
/// inputs that are their references (not controlled) are rows of the unit matrix exactly. Variances
/// to first order with all correlations: δG = (δP − G δS) S⁻¹ of each period and realisation. Where
/// S is hard to invert (condition above 1000, or an entry that counts within three of its
/// deviations) a note says on which lines.
/// @throws InvalidInput  as frf_estimate(); no reference for each input
[[nodiscard]] ClosedLoopEstimate closed_loop_estimate(const Spectra& spectra,
                                                      const FrfEstimateOptions& options = {});
[[nodiscard]] ClosedLoopEstimate closed_loop_estimate(const TimeData& data,
                                                      const FrfEstimateOptions& options = {});

}  // namespace chladni::identification
