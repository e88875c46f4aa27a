// What a sound simulation and a measurement of it may differ by, line by line.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/diagnosed.h"

namespace chladni::diagnosis {

/// Sums over the measured responses of each of k lines.
struct ErrorBand {
  Eigen::VectorXd frequency_hz;  ///< k
  Eigen::VectorXd noise;         ///< k: Σ σ² [m²/N²]
  /// k: Σ |dG/dη|² over all tolerances [m²/N²], to first order about the simulation as it is; by
  /// each of them at most the square of the simulated responses.
  Eigen::VectorXd model;
};

/// Cost: a slope of each tolerance and each error of a shape, on all lines.
/// @throws as diagnosed
[[nodiscard]] ErrorBand error_band(const Structure& structure, const modal::FrfSet& measured,
                                   const Tolerances& tolerances);

}  // namespace chladni::diagnosis
