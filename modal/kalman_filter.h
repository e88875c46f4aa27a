// The Kalman filter of a sampled model in steady state: what cannot be measured, from what can.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modal/disturbed_model.h"

namespace chladni::modal {

/// With e = y − C x − D u of this sample: z ≈ C_z x + D_z u + `point_gain` e, and the state for the
/// next sample is A x + B u + `gain` e. x is the estimate from all earlier samples.
struct KalmanFilter {
  DisturbedModel system;
  Eigen::MatrixXd gain;                   ///< n×p
  Eigen::MatrixXd point_gain;             ///< z×p
  Eigen::MatrixXd covariance;             ///< n×n, of x from all earlier samples
  Eigen::MatrixXd innovation;             ///< p×p, covariance of e
  Eigen::MatrixXd point_covariance;       ///< z×z, of z with this sample's y
  Eigen::MatrixXd prediction_covariance;  ///< z×z, of z without it
  Eigen::VectorXcd pole;  ///< n, eigenvalues of A − gain C: all below 1 in magnitude
};

/// Cost: that of dense::prediction_covariance, and 25 n³.
/// @throws InvalidInput      a state that does not decay is seen by no sensor, or moved by no
///                           disturbance; the message names it
/// @throws NumericalFailure  as dense::prediction_covariance
[[nodiscard]] KalmanFilter kalman_filter(const DisturbedModel& system);

/// States that do not decay and that no sensor sees, or that no disturbance moves: by the test of
/// Popov, Belevitch and Hautus at each eigenvalue on or outside the unit circle. A name of a state
/// for each, the one with the largest part in it.
[[nodiscard]] std::vector<std::string> unseen_states(const DisturbedModel& system);
[[nodiscard]] std::vector<std::string> undisturbed_states(const DisturbedModel& system);

/// The filter as a model that steps by itself: inputs u, then y; outputs z, then the innovations e.
/// Delays of u are those of the filter's model.
[[nodiscard]] ControlModel observer_model(const KalmanFilter& filter);

/// Course of an estimate over N samples.
struct Estimate {
  Eigen::MatrixXd points;      ///< N×z
  Eigen::MatrixXd innovation;  ///< N×p
  Eigen::MatrixXd states;      ///< N×n: x, from all earlier samples; empty if not asked for
};

/// Steps through recorded samples from rest. Cost: N n (n + p + q).
/// @param inputs   N×q: the known inputs at the samples
/// @param outputs  N×p: the sensors at the samples
/// @throws InvalidInput  sizes differ, or a sample is not finite
[[nodiscard]] Estimate estimate(const KalmanFilter& filter, const Eigen::MatrixXd& inputs,
                                const Eigen::MatrixXd& outputs, bool with_states = false);

}  // namespace chladni::modal
