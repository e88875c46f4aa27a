// What a fit leaves unknown of the motion as a rigid body at places without a sensor.
#pragma once

#include <Eigen/Core>

#include "identification/gain_match.h"
#include "identification/spatio_temporal.h"

namespace chladni::identification {

/// Standard deviations of the rows D T of the body's modes, n×r, by the first change of T with M⁻¹.
/// Infinite where the covariance of M⁻¹ is.
/// @param directions  n×r, D
/// @throws InvalidInput  the body has no covariance of its r×r inverse mass
[[nodiscard]] Eigen::MatrixXd rigid_deviation(const RigidBody& body,
                                              const Eigen::MatrixXd& directions);

/// Variance of Σ φ(ρ) r over the rigid-body modes, n×q: of s² G. With a body both factors err
/// together, as D M⁻¹ D_aᵀ; without one, and in rows that are 0, which are not those of the body,
/// those of the places and of the actuators count as independent. Infinite or NaN: not known.
[[nodiscard]] Eigen::MatrixXd rigid_variance(const ModalFit& fit, const GainMatch& match,
                                             const PlacesOfInterest& places);

}  // namespace chladni::identification
