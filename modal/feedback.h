// Sampled feedback around a disturbed model: stability, margins and what the disturbances leave.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "modal/disturbed_model.h"
#include "modal/kalman_filter.h"

namespace chladni::modal {

/// x⁺ = A x + B a, u = C x + D a.
struct FeedbackLaw {
  Eigen::MatrixXd a, b, c, d;
};

/// a = `sensors` y, or with a filter a = `points` ẑ, ẑ its estimates with this sample's sensors.
/// The forces u = law(a) act `delay` samples later, and the filter knows them, but no others.
struct Feedback {
  FeedbackLaw law;
  std::vector<Eigen::Index> actuators;  ///< known inputs of the model, one for each row of law.c
  Eigen::MatrixXd sensors;              ///< r×p; without a filter
  std::optional<KalmanFilter> filter;
  Eigen::MatrixXd points;  ///< r×z; with a filter
  Eigen::Index delay = 1;  ///< samples of the computer, 1 or more
};

struct ClosedLoop {
  double spectral_radius = 0.0;  ///< the loop is stable below 1
  Eigen::VectorXcd pole;         ///< n, eigenvalues of the loop from sample to sample
  Eigen::VectorXd rms;           ///< of z of the model under its disturbances; empty: unstable
};

/// Cost: 40 n³ with all states n of model, filter, law and delay.
/// @throws InvalidInput  sizes do not fit together
[[nodiscard]] ClosedLoop closed_loop(const DisturbedModel& plant, const Feedback& feedback);

/// Least singular value of I − L(e^{jωT}) over the frequencies, L from the forces on the model
/// around the loop to those of the computer, which alone a filter knows: the distance to the
/// critical point, which any change of the loop below it leaves stable. Meaningful of a stable
/// loop. Cost: n³ per frequency.
/// @throws InvalidInput  sizes do not fit together
[[nodiscard]] double modulus_margin(const DisturbedModel& plant, const Feedback& feedback,
                                    const Eigen::VectorXd& frequency_hz);

/// The lines of a margin with those that its narrow minima need: at the angle of each pole of the
/// loop whose half bandwidth is less than the gap between its neighbours among the lines, and half
/// and whole half bandwidths beside it. Only between the first and the last line.
/// @param frequency_hz  ascending
/// @param pole          of closed_loop
[[nodiscard]] Eigen::VectorXd with_resonances(const Eigen::VectorXd& frequency_hz,
                                              const Eigen::VectorXcd& pole, double sample_time_s);

}  // namespace chladni::modal
