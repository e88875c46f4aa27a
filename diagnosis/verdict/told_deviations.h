// Standard deviations of the numbers of causes, as they are told.
#pragma once

#include <Eigen/Core>

#include "diagnosis/diagnosed.h"
#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// How much further each coordinate of the causes may be off than the standard deviation of
/// `fit.covariance` says: n factors from 1 to Constants::longest_deviation, n = coordinate_count().
/// Places and offsets alone are looked at, the others have 1. On both sides of the fit all other
/// numbers are fitted again. A normal density falls by a factor of e² within two deviations; where
/// it falls by less, the deviation is longer. So it is for the place of a mass beside the axis of a
/// strip whose channels stand on that axis: the responses hold the square of its distance. Cost:
/// for each place two to twice Constants::deviation_looks fits of Constants::steps_beside.
[[nodiscard]] Eigen::VectorXd longer_deviations(const Problem& problem, const Fit& fit);

/// Widens the standard deviations of the causes of an explanation, which belong to `fit`: as
/// longer_deviations says, and by the errors of the causes (Explanation::error_excess). An error of
/// the shapes by mesh or solver is added to the deviations of sizes, places and resonances:
/// Problem::solver_error is that of φ². A size has all of it. A place is off by what changes φ by
/// half of it, over the flexible modes of the band: ½ error sqrt(Σ φ² / Σ (dφ/dx)²). A resonance
/// of a mass m on a mode lies beside the pole by sqrt(m φ²) / 2 of its frequency, and errs by half
/// of that error of the distance.
/// Cost: that of longer_deviations.
void widen_deviations(const Problem& problem, const Fit& fit, Explanation& explanation);

}  // namespace chladni::diagnosis
