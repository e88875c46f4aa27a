// The noise of a disturbed model that its recordings ask for.
#pragma once

#include <Eigen/Core>
#include <span>

#include "modal/disturbed_model.h"

namespace chladni::modal {

/// Samples of the known inputs and of the sensors.
struct RecordedSamples {
  Eigen::MatrixXd inputs, outputs;  ///< N×q, N×p
};

/// Factors on what a model states of its noise.
struct NoiseFactors {
  double disturbances = 1.0;  ///< on DisturbedModel::noise_rms
  double sensors = 1.0;       ///< on DisturbedModel::sensor_rms
  /// [ln] Likelihood of the recordings with both factors over that with 1 and 1.
  double gain = 0.0;
  /// The ratio of the factors is at an end of what was tried: the recordings do not determine it.
  bool at_end = false;

  [[nodiscard]] bool is_learned() const { return disturbances != 1.0 || sensors != 1.0; }
};

/// The factors under which the innovations of the Kalman filter are most likely: the error of a
/// model acts on a filter like more noise than is stated, at the sensors where shapes are wrong, at
/// the forces where modes are. The gain of a filter depends on the ratio of the factors alone,
/// which is sought between 1e-4 and 1e4; the size follows from the innovations.
/// @param from  samples of each record that are left out while the filter settles; shorter records
///              are left out
/// Cost: some 40 filters, each over all samples.
/// Source: R. K. Mehra, IEEE Trans. Automatic Control 15 (1970) 175; likelihood by innovations: F.
/// C. Schweppe, IEEE Trans. Information Theory 11 (1965) 61.
/// @throws InvalidInput      no record is longer than `from`; as modal::estimate
/// @throws NumericalFailure  no filter has a finite likelihood
[[nodiscard]] NoiseFactors learned_noise(const DisturbedModel& system,
                                         std::span<const RecordedSamples> records,
                                         Eigen::Index from);

/// The model with its noise times these factors.
[[nodiscard]] DisturbedModel with_noise(DisturbedModel system, const NoiseFactors& factors);

/// For each sensor, root mean square of the error of its estimate from the other sensors over the
/// deviation that the filter states for it, p; NaN where the others leave a state unseen. About 1
/// if the model and its noise are true; more where the errors of the model follow each other in
/// time and over the body, so that more samples and sensors teach less than white noise would have
/// it. Cost: p filters, each over all samples. @throws  as learned_noise
[[nodiscard]] Eigen::VectorXd left_out_errors(const DisturbedModel& system,
                                              std::span<const RecordedSamples> records,
                                              Eigen::Index from);

}  // namespace chladni::modal
