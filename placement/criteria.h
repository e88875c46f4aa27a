// Ways to say how good a place is for a collocated sensor-actuator pair.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "modal/groups.h"

namespace chladni::placement {

/// What a criterion sees of one model: n candidate sites, m wanted modes in g groups, p pairs that
/// are there already, q actuators.
struct PairView {
  std::vector<modal::ModeGroup> groups;
  Eigen::MatrixXd shapes;          ///< n×m [kg^-1/2]
  Eigen::MatrixXd slopes;          ///< n×m [kg^-1/2 m^-1], along the surface
  Eigen::MatrixXd present;         ///< p×m [kg^-1/2]
  Eigen::MatrixXd present_slopes;  ///< p×m
  Eigen::MatrixXd actuators;       ///< q×m [kg^-1/2]: what the pair's gain is to bring to scale
  Eigen::VectorXd largest;       ///< g: largest ‖φ_group‖/√k on the whole surface [kg^-1/2]
  Eigen::VectorXd rms;           ///< g: root mean square of a mode of the group there [kg^-1/2]
  Eigen::VectorXd sensor_noise;  ///< m: standard deviation of an identified entry of L [kg^-1/2]
  Eigen::VectorXd actuator_noise;  ///< m: of R
  double position_error = 0.0;     ///< [m]: standard deviation per axis, of sensor and actuator

  [[nodiscard]] Eigen::Index site_count() const { return shapes.rows(); }
  [[nodiscard]] Eigen::Index group_count() const {
    return static_cast<Eigen::Index>(groups.size());
  }
};

/// A criterion scores each site for each group of modes; larger is better. What counts is the worst
/// group: it limits the site. Scores are blind to the sign of a mode and to a rotation of the modes
/// within a group.
struct Criterion {
  std::string_view name;     ///< as a study writes it: criterion = "weakest_mode"
  std::string_view summary;  ///< one line
  std::string_view source;   ///< where it comes from
  std::string_view unit;     ///< of `for_people`
  /// n×g, finite, 0 or more.
  Eigen::MatrixXd (*score)(const PairView& view);
  /// The score as an engineer wants to read it.
  double (*for_people)(double score);
};

/// All criteria, in the order a user should meet them.
[[nodiscard]] std::span<const Criterion* const> criteria();

/// @throws InvalidInput  there is none of that name; the message lists those there are
[[nodiscard]] const Criterion& criterion(std::string_view name);

/// How strongly the pairs in place and one at each site see each group, n×g: the root of the
/// smallest eigenvalue of Σ_c w_c φ(c) φ(c)ᵀ over the modes of the group, w_c given by `weights`
/// ((p + n)×g, pairs in place first). k modes that cannot be told apart need k pairs; with fewer,
/// it is the root of the mean eigenvalue: what one of them gets when they are split evenly.
[[nodiscard]] Eigen::MatrixXd visibility(const PairView& view, const Eigen::MatrixXd& weights);

/// The standard deviation of ln α of each group, n×g, from gain matching over the pairs (5.5):
/// Var ln β = (σ_s² + σ_a² + 2 σ_p² |∇φ|²) / φ² for one pair, β = α².
[[nodiscard]] Eigen::MatrixXd alpha_deviation(const PairView& view);

}  // namespace chladni::placement
