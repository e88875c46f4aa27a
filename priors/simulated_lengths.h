// Length scales of a simulation's modes, as the thesis learns them: from dense samples.
#pragma once

#include <string>
#include <vector>

#include "priors/interpolator.h"
#include "priors/learning.h"

namespace chladni::priors {

/// Up to `count` of the points, each as far as can be from those chosen before it; the first is the
/// one farthest from their mean. The same rows every time.
[[nodiscard]] std::vector<Eigen::Index> spread_points(const Points& points, Eigen::Index count);

/// What was learned of the flexible modes that move the surface along the common direction.
struct SimulatedLengths {
  std::vector<Eigen::Index> columns;  ///< of the simulation's modes
  Eigen::VectorXd frequency_hz;       ///< of those
  std::vector<Learned> learned;       ///< of those
  double longest = 0.0;               ///< of the range [m]
};

/// Of those up to `most_hz` (at least the first), from up to 400 points of the surface.
/// @throws InvalidInput  the simulation has no flexible mode that moves the surface; the points
/// have
///                       no common direction
[[nodiscard]] SimulatedLengths simulated_lengths(const std::string& method, const Kernel& kernel,
                                                 const Simulation& simulation, double most_hz);

/// The number, among those learned, of the most complex mode: that of the shortest length.
[[nodiscard]] int shortest(const SimulatedLengths& lengths);

/// The number, among those learned, of the mode that a measured shape resembles most at its places
/// (modal assurance criterion) within a factor of two in frequency; −1 where the shape is a rigid
/// body's, far below all flexible ones.
[[nodiscard]] int matching(const SimulatedLengths& lengths, const MeasuredShapes& measured,
                           Eigen::Index mode);

}  // namespace chladni::priors
