// Matrices of low rank of which only the measured responses are known.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::identification {

/// p×q: whether a response was measured.
using MeasuredResponses = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// @param weight  K×pq: 0 where nothing was measured
[[nodiscard]] MeasuredResponses measured_responses(const Eigen::MatrixXd& weight,
                                                   Eigen::Index outputs);

/// Channels that measured responses connect, directly or through others.
struct ConnectedChannels {
  std::vector<Eigen::Index> outputs, inputs;  ///< one or more of each, ascending
};

/// The connected channels of each part. Channels without any measured response are in none.
[[nodiscard]] std::vector<ConnectedChannels> connected_channels(const MeasuredResponses& measured);

/// The matrix with other values where nothing was measured: those of a matrix of this rank that is
/// nearest to the measured entries. A zero there would count as measured, and a residue of rank one
/// would then have two directions or more. Entries between parts without a common channel stay as
/// they are, since nothing tells them; so do all entries of a matrix that was measured in full.
/// Cost: p q² r² + (r q)³ for q ≤ p (else with both exchanged) per step of Levenberg and Marquardt,
/// in nine descents of some five to ten steps; nothing where all was measured.
/// @param value     p×q
/// @throws NumericalFailure  something is filled in, and an entry is not finite
[[nodiscard]] Eigen::MatrixXd completed(const Eigen::MatrixXd& value,
                                        const MeasuredResponses& measured, Eigen::Index rank);
[[nodiscard]] Eigen::MatrixXcd completed(const Eigen::MatrixXcd& value,
                                         const MeasuredResponses& measured, Eigen::Index rank);

}  // namespace chladni::identification
