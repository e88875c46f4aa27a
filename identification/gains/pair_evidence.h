// What the collocated pairs of a fit say before anything is scaled.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/gain_match.h"
#include "identification/gains/matched_sides.h"

namespace chladni::identification {

/// φ at the sensor over φ at the actuator that a simulation expects, n_c×m; 1 at one place.
struct PlaceRatios {
  Eigen::MatrixXd value, deviation;
};
/// @throws InvalidInput  shapes that are not m each
[[nodiscard]] PlaceRatios place_ratios(const std::vector<CollocatedPair>& pairs, Eigen::Index modes,
                                       double simulation_error);

/// Residue L R at each pair, summed over a group of modes (so that no basis matters), over its sign
/// as the places ask for it; n_c×groups.
struct PairResidues {
  Eigen::MatrixXd value, deviation;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> telling;  ///< beyond `significance`
};
[[nodiscard]] PairResidues pair_residues(const ModalFit& fit,
                                         const std::vector<modal::ModeGroup>& groups,
                                         const std::vector<CollocatedPair>& pairs,
                                         const PlaceRatios& ratios, double significance);

/// +1 or −1 per pair: how its sensor and actuator count; all −1: the two sides do.
[[nodiscard]] Eigen::VectorXi pair_signs(const PairResidues& residues);

/// The fit's group of modes, rigid-body modes at 0 Hz as one; single ones where it has none.
[[nodiscard]] std::vector<modal::ModeGroup> matched_groups(const ModalFit& fit);

/// C of L and R of a mode, (p+q) squared; zeros where the fit has none.
[[nodiscard]] Eigen::MatrixXd shape_covariance(const ModalFit& fit, Eigen::Index mode);

/// ln|L_cm| − ln|ratio R_mc| = ln ρ_c + 2 ln α_m by weighted least squares over pairs and single
/// modes that tell (section 2.7 of the method: the two-way layout).
struct PairGains {
  std::vector<PairGain> gains;
  /// Of each pair and group, in deviations: what the two-way layout leaves; 0 where it is not told.
  Eigen::MatrixXd left;
};
[[nodiscard]] PairGains pair_gains(const ModalFit& fit, const std::vector<modal::ModeGroup>& groups,
                                   const std::vector<CollocatedPair>& pairs,
                                   const PlaceRatios& ratios, const PairResidues& residues);

}  // namespace chladni::identification
