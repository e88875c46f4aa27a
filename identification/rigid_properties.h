// Mass, centre of mass and inertia of a body from its rigid-body responses in any directions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/decoupling.h"
#include "identification/gain_match.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Σ l_m r_m over the modes in which the body moves as a whole: G s² of the free body.
struct RigidProduct {
  Eigen::MatrixXd value;       ///< p×q [1/kg]
  Eigen::MatrixXd covariance;  ///< pq×pq of its columns one after the other; zero if not known,
                               ///< infinite on the diagonal for a channel that is not measured
  Eigen::Index modes = 0;
};

/// The product of the modes at 0 Hz and the `suspended` ones above it, which are taken for
/// independent. Values are those of the matched shapes, whose gains are corrected; the covariance
/// is that of the fit, times the misfit of the rigid body where it is above 1.
/// @throws InvalidInput  a suspended mode is none of the fit's
[[nodiscard]] RigidProduct rigid_product(const ModalFit& fit, const GainMatch& match,
                                         const std::vector<Eigen::Index>& suspended);

/// Deviations are infinite and values NaN for what the channels' places and directions do not tell.
struct RigidProperties {
  double mass = 0.0, mass_std = 0.0;     ///< [kg]
  Eigen::Vector3d centre, centre_std;    ///< [m]
  Eigen::Matrix3d inertia, inertia_std;  ///< [kg m²], about the centre of mass
  Eigen::Vector3d about;  ///< the centre; where it is not told, the middle of the channels
  std::vector<std::string> not_told;  ///< "the inertia about z": not told by the channels
};

/// Weighted least squares of n_iᵀ n_j / m + ((p_i − c) × n_i)ᵀ J⁻¹ ((p_j − c) × n_j), the response
/// of a rigid body at p_i along n_i to a force at p_j along n_j, with the covariance of `product`;
/// a product of infinite variance has no weight. Products that contradict a rigid body by more than
/// chance, five deviations (a wrong gain or place), are as uncertain as they contradict it; where
/// no covariance is stated, what is left of the products tells it.
/// Where the channels see rotations about some axes only, the inertia about these is given for a
/// body whose products of inertia with the other axes are 0.
/// Cost: some tens of pq × 10 least-squares problems.
/// @throws InvalidInput      sizes differ
/// @throws NumericalFailure  mass or inertia is not positive: a polarity or a place is wrong, or
///                           the modes are not those of a rigid body
[[nodiscard]] RigidProperties rigid_properties(const RigidProduct& product,
                                               const ChannelFrame& outputs,
                                               const ChannelFrame& inputs);

}  // namespace chladni::identification
