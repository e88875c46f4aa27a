// Length scales of a simulation's modes, as the thesis learns them: from dense samples.
#pragma once

#include <string>
#include <vector>

#include "priors/interpolator.h"
#include "priors/learning.h"

namespace chladni::priors {

/// Chooses up to `count` points; each next one is the farthest from those chosen before, the first
/// is the farthest from the mean. The choice is deterministic.
[[nodiscard]] std::vector<Eigen::Index> spread_points(const Points& points, Eigen::Index count);

/// Learned lengths of the flexible modes that move the surface along the common direction.
struct SimulatedLengths {
  std::vector<Eigen::Index> columns;  ///< columns of the simulation's modes
  Eigen::VectorXd frequency_hz;       ///< of these modes
  std::vector<Learned> learned;       ///< of these modes
  double longest = 0.0;               ///< longest length of the range [m]
};

/// Learns from the modes up to `most_hz` (at least the first), at up to 400 points of the surface.
/// @throws InvalidInput  the simulation has no flexible mode that moves the surface; the points
///                       have no common direction
[[nodiscard]] SimulatedLengths simulated_lengths(const std::string& method, const Kernel& kernel,
                                                 const Simulation& simulation, double most_hz);

/// Index, among the learned modes, of the most complex one, which has the shortest length.
[[nodiscard]] int shortest(const SimulatedLengths& lengths);

/// Index, among the learned modes, of the mode that is most similar to a measured shape at its
/// places (modal assurance criterion). Only modes within a factor of two in frequency count, if
/// there are any. −1 for a frequency below a quarter of the first flexible one: a rigid-body shape.
[[nodiscard]] int matching(const SimulatedLengths& lengths, const MeasuredShapes& measured,
                           Eigen::Index mode);

}  // namespace chladni::priors
