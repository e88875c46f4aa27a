// Information from the collocated pairs of a fit before anything is scaled.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/gain_match.h"
#include "identification/gains/matched_sides.h"

namespace chladni::identification {

/// −1: the stated directions of the two channels are opposite; else 1.
[[nodiscard]] int sign_of_pair(const modal::MeasuredChannel& output,
                               const modal::MeasuredChannel& input);

/// φ at the sensor over φ at the actuator in a simulation, n_c×m; the pair's sign for both at one
/// place.
struct PlaceRatios {
  Eigen::MatrixXd value, deviation;
};
/// @throws InvalidInput  a pair has not m simulated shapes on each side
[[nodiscard]] PlaceRatios place_ratios(const std::vector<CollocatedPair>& pairs, Eigen::Index modes,
                                       double simulation_error);

/// Residue L R at each pair, times the sign that the places require, summed over a group of modes
/// (so that no basis matters); n_c×groups.
struct PairResidues {
  Eigen::MatrixXd value, deviation;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> telling;  ///< beyond `significance`
};
[[nodiscard]] PairResidues pair_residues(const ModalFit& fit,
                                         const std::vector<modal::ModeGroup>& groups,
                                         const std::vector<CollocatedPair>& pairs,
                                         const PlaceRatios& ratios, double significance);

/// +1 or −1 per pair: the relative direction of its sensor and actuator. All −1: the two sides have
/// opposite directions.
[[nodiscard]] Eigen::VectorXi pair_signs(const PairResidues& residues);

/// The fit's groups of modes, all rigid-body modes at 0 Hz as one; else single modes.
[[nodiscard]] std::vector<modal::ModeGroup> matched_groups(const ModalFit& fit);

/// Covariance C of L and R of a mode, (p+q) squared; zeros if the fit has none.
[[nodiscard]] Eigen::MatrixXd shape_covariance(const ModalFit& fit, Eigen::Index mode);

/// ln|L_cm| − ln|ratio R_mc| = ln ρ_c + 2 ln α_m by weighted least squares over the pairs and
/// single modes that count (section 2.7 of the method: the two-way layout).
struct PairGains {
  std::vector<PairGain> gains;
  /// Residual of the two-way layout for each pair and group, in deviations; 0 without information.
  Eigen::MatrixXd left;
};
[[nodiscard]] PairGains pair_gains(const ModalFit& fit, const std::vector<modal::ModeGroup>& groups,
                                   const std::vector<CollocatedPair>& pairs,
                                   const PlaceRatios& ratios, const PairResidues& residues);

/// Number of parts of the told gains that no mode compares with each other.
[[nodiscard]] Eigen::Index gain_parts(const std::vector<PairGain>& gains);

/// Deviation of ln of a gain that no mode tells: what the told ones scatter by, about the mean of 0
/// of their part. 0 where no two are in one part.
[[nodiscard]] double gain_scatter(const std::vector<PairGain>& gains);

/// Deviation of ln of each gain over the mean of all pairs. Where it is not known, it is guessed to
/// scatter as the told ones do: n pairs of a part then know its mean to the n-th part of the
/// variance.
[[nodiscard]] Eigen::VectorXd gain_doubts(const std::vector<PairGain>& gains);

}  // namespace chladni::identification
