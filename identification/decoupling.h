// Rigid-body motions of channels, and the matrices that turn channels into such motions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "modal/frf_set.h"

namespace chladni::identification {

/// Displacements of the reference point along x, y, z and rotations about it.
inline constexpr std::array<const char*, 6> kRigidMotions{"x", "y", "z", "rx", "ry", "rz"};

/// Channels do not see a motion whose singular value is below this part of the largest. Directions
/// from files in single precision are off by 1e-7, which is no motion; a direction turned by a
/// degree is one.
inline constexpr double kNoMotion = 1e-4;

/// Places [m] and unit directions of n channels.
struct ChannelFrame {
  Eigen::MatrixX3d places, directions;
};

/// None if a channel has no place or no direction.
[[nodiscard]] std::optional<ChannelFrame> channel_frame(
    const std::vector<modal::MeasuredChannel>& channels);

/// P, n×6: rows [n, (p − about) × n]. Displacements of the channels are P (translation, rotation);
/// a force on each gives Pᵀ u as force and moment about the point.
[[nodiscard]] Eigen::MatrixXd rigid_motions(const ChannelFrame& frame,
                                            const Eigen::Vector3d& about);

struct Decoupling {
  std::vector<Eigen::Index> told;   ///< motions (0 to 5) that the channels tell apart
  std::vector<Eigen::Index> mixed;  ///< motions that they see only together with others
  std::vector<Eigen::Index> unseen;
  Eigen::Index rank = 0;  ///< motions or combinations of motions that are seen
  Eigen::MatrixXd matrix;
  double condition = 0.0;  ///< of P on its rank, lengths over the rms distance from `about`
};

/// Sensors to rigid-body motion: the displacements and rotations `told` are matrix (told×n) times
/// the sensors' displacements, the best in the sense of least squares.
/// @throws InvalidInput  no channel, or sizes of places and directions differ
[[nodiscard]] Decoupling sensor_decoupling(const ChannelFrame& sensors,
                                           const Eigen::Vector3d& about);

/// Actuators to rigid-body force: forces matrix (n×told) times the wanted forces and moments
/// `told`, with no other force or moment that can be avoided and the smallest sum of squares.
/// @throws InvalidInput  as sensor_decoupling
[[nodiscard]] Decoupling actuator_decoupling(const ChannelFrame& actuators,
                                             const Eigen::Vector3d& about);

/// "4 sensors tell z, rx, ry apart, 1 more than needed (condition 1.3); x, y, rz are not seen."
[[nodiscard]] std::string decoupling_text(const Decoupling& decoupling, bool actuators);

}  // namespace chladni::identification
