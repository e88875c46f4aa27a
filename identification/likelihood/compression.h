// Reduces many channels to few: what all responses share lies in a small space on each side.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// G ≈ left Z rightᵀ; Z is r×s and its noise is white.
struct Compressed {
  FitData data;                  ///< of Z
  Eigen::MatrixXd left, right;   ///< p×r, q×s; their rows hold 1/a and 1/b as factors
  Eigen::MatrixXd left_back;     ///< r×p: left_back left = 1
  Eigen::MatrixXd right_back;    ///< s×q
  Eigen::VectorXd output_scale;  ///< p: a in w_ijk = a_i b_j c_k
  Eigen::VectorXd input_scale;   ///< q: b
};

/// Finds the directions of the outputs and of the inputs in which the whitened data exceed the
/// noise: left and right singular vectors in the metric of the noise. Empty if the weights are not
/// products a_i b_j c_k (to 10 % rms) or if single values are missing.
/// Cost: 4 K pq (p + q) operations; 2 K p + K r q numbers beside the data.
[[nodiscard]] std::optional<Compressed> compressed(const FitData& data);

/// Random orthogonal combinations of the channels, at most `size` on each side. They contain every
/// mode, and none alone. Equal sizes give equal combinations.
[[nodiscard]] FitData sketched(const FitData& data, Eigen::Index size);

/// Turns a fit of `small.data` into a fit of all channels, with residual and cost of the full data.
/// The deviations of shapes are those within the small space; outside of it, those that the
/// channel's noise gives with everything else fixed.
/// Cost: 4 K pq (modes) operations, one input's responses at a time.
[[nodiscard]] ModalFit expanded(const ModalFit& fit, const Compressed& small, const FitData& data);

}  // namespace chladni::identification
