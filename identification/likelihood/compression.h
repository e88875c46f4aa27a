// Many channels as few: what all responses have in common is in a small space on each side.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// G ≈ left Z rightᵀ, Z being r×s and its noise white.
struct Compressed {
  FitData data;                  ///< of Z
  Eigen::MatrixXd left, right;   ///< p×r, q×s; their rows are deviations' units
  Eigen::MatrixXd left_back;     ///< r×p: left_back left = 1
  Eigen::MatrixXd right_back;    ///< s×q
  Eigen::VectorXd output_scale;  ///< p: a of w_ijk = a_i b_j c_k
  Eigen::VectorXd input_scale;   ///< q: b
};

/// The directions of the outputs and of the inputs in which the whitened data stand out of the
/// noise: left and right singular vectors, in the metric of the noise. Empty where the weights are
/// no products a_i b_j c_k (to 10 % in the mean square) or single values are missing.
/// Cost: 4 K pq (p + q) operations; 2 K p + K r q numbers beside the data.
[[nodiscard]] std::optional<Compressed> compressed(const FitData& data);

/// Random orthogonal combinations of the channels, `size` on each side at most: every mode is in
/// them, none alone. The same for the same sizes.
[[nodiscard]] FitData sketched(const FitData& data, Eigen::Index size);

/// A fit of `small.data` as one of all channels, residual and cost those of the data. Deviations of
/// shapes are those within the small space, and beside it what the noise of the channel allows with
/// all else given.
/// Cost: 4 K pq (modes) operations, one input's responses at a time.
[[nodiscard]] ModalFit expanded(const ModalFit& fit, const Compressed& small, const FitData& data);

}  // namespace chladni::identification
