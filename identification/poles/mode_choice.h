// Decides which poles are modes of the structure, and which of them count twice.
#pragma once

#include <complex>
#include <vector>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {

/// Least growth of the cost without a pole, so that the pole is more than noise.
[[nodiscard]] double least_significance(const FitData& data, double cost);

/// Removes first the poles that are no modes, then, one by one, those not worth their parameters.
/// @param problem  of `poles`; @param modes  number of modes to keep; 0: all that are worth it
[[nodiscard]] Eigen::VectorXcd worthwhile(const FitData& data, const ResidueProblem& problem,
                                          const Eigen::VectorXcd& poles, Eigen::Index modes);

/// One pole for each resonance: a pole is removed if a stronger one is within three bandwidths (of
/// the sharper pole) or three lines.
[[nodiscard]] Eigen::VectorXcd strongest(const FitData& data, const Eigen::VectorXcd& poles,
                                         bool rigid);

/// The poles whose damping is within a factor Constants::unusual of the usual one, without the
/// weaker one of two within half a bandwidth.
[[nodiscard]] Eigen::VectorXcd without_unusual(const FitData& data, const Eigen::VectorXcd& poles,
                                               bool rigid);

/// Whether a further mode looks like an artefact beside a resonance: within a bandwidth of an
/// existing mode, or with more than ten times the largest damping. Always false where a
/// variance is stated.
[[nodiscard]] bool is_satellite(const FitData& data, const ModalFit& fit,
                                const std::complex<double>& pole);

/// Poles that are alone within a bandwidth and have a second residue direction above noise: these
/// are two modes of one frequency.
[[nodiscard]] std::vector<Eigen::Index> repeated(const FitData& data, const Eigen::VectorXcd& poles,
                                                 const Residues& residues);

/// Number of directions of the 1/s² term that exceed noise.
[[nodiscard]] Eigen::Index rigid_rank(const FitData& data, const Residues& residues,
                                      Eigen::Index most);

}  // namespace chladni::identification
