// Which poles are modes of a structure, and how often.
#pragma once

#include <complex>
#include <vector>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {

/// By how much the cost must grow without a pole for it to be more than noise.
[[nodiscard]] double least_significance(const FitData& data, double cost);

/// The poles that are left of all when those that are no modes are left out, and then, one after
/// the other, those that are not worth their parameters.
/// @param problem  of `poles`; @param modes  how many to keep; 0: as many as are worth it
[[nodiscard]] Eigen::VectorXcd worthwhile(const FitData& data, const ResidueProblem& problem,
                                          const Eigen::VectorXcd& poles, Eigen::Index modes);

/// One pole of each resonance: those that have a stronger one within three bandwidths of the
/// sharper or three lines are left out.
[[nodiscard]] Eigen::VectorXcd strongest(const FitData& data, const Eigen::VectorXcd& poles,
                                         bool rigid);

/// Whether a further mode looks like what data have beside a resonance: within a bandwidth of a
/// mode that is there, or damped ten times more than they are at most.
[[nodiscard]] bool is_satellite(const FitData& data, const ModalFit& fit,
                                const std::complex<double>& pole);

/// Poles of which the residue has a second direction that is no noise, alone within a bandwidth:
/// two modes of one frequency.
[[nodiscard]] std::vector<Eigen::Index> repeated(const FitData& data, const Eigen::VectorXcd& poles,
                                                 const Residues& residues);

/// How many directions of the 1/s² term stand out of the noise.
[[nodiscard]] Eigen::Index rigid_rank(const FitData& data, const Residues& residues,
                                      Eigen::Index most);

}  // namespace chladni::identification
