// Frequency responses of a structure that a loop holds: the indirect three-point approach (thesis
// (4.3), (4.4); van den Hof 1998; Pintelon and Schoukens 2012, section 2.6).
#pragma once

#include "recordings/frf_estimate.h"

namespace chladni::recordings {

struct ClosedLoopEstimate {
  FrfEstimate estimate;                       ///< of the structure, from commands to outputs
  Eigen::VectorXd condition;                  ///< per line, of the input sensitivity S
  std::vector<Eigen::MatrixXcd> sensitivity;  ///< [k], q×q: S, from references to inputs
};

/// The estimate averages P (references to outputs) and S (references to inputs) over periods and
/// realisations. Then G = P S⁻¹, by the matrix inverse on each line. An input that is its own
/// reference (not controlled) gives S an exact row of the unit matrix. The variances are of first
/// order with all correlations: δG = (δP − G δS) S⁻¹ of each period and realisation. Notes count
/// the lines where S is hard to invert: condition above 1000, or a smallest singular value below
/// three times the largest deviation in S.
/// @throws InvalidInput  as frf_estimate(); no reference for each input
[[nodiscard]] ClosedLoopEstimate closed_loop_estimate(const Spectra& spectra,
                                                      const FrfEstimateOptions& options = {});
/// The same on lines that are all excited, from one realisation after the other.
/// @throws InvalidInput  as closed_loop_estimate()
[[nodiscard]] ClosedLoopEstimate closed_loop_of_excited(const SpectraSource& excited,
                                                        const FrfEstimateOptions& options);
[[nodiscard]] ClosedLoopEstimate closed_loop_estimate(const TimeData& data,
                                                      const FrfEstimateOptions& options = {});

}  // namespace chladni::recordings
