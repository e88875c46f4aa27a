// Criteria for the place of a collocated sensor-actuator pair.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "modal/groups.h"

namespace chladni::placement {

/// Input of a criterion for one model: n candidate sites, m wanted modes in g groups, p existing
/// pairs, q actuators.
struct PairView {
  std::vector<modal::ModeGroup> groups;
  Eigen::MatrixXd shapes;          ///< n×m [kg^-1/2]
  Eigen::MatrixXd slopes;          ///< n×m [kg^-1/2 m^-1], along the surface
  Eigen::MatrixXd present;         ///< p×m [kg^-1/2]
  Eigen::MatrixXd present_slopes;  ///< p×m
  Eigen::MatrixXd actuators;       ///< q×m [kg^-1/2]: the actuators that the pair's gain scales
  Eigen::VectorXd largest;       ///< g: largest ‖φ_group‖/√k on the surface [kg^-1/2]
  Eigen::VectorXd rms;           ///< g: root mean square of a mode of the group [kg^-1/2]
  Eigen::VectorXd sensor_noise;  ///< m: standard deviation of an identified entry of L [kg^-1/2]
  Eigen::VectorXd actuator_noise;  ///< m: the same for R
  double position_error = 0.0;     ///< [m]: standard deviation per axis, of sensor and actuator

  [[nodiscard]] Eigen::Index site_count() const { return shapes.rows(); }
  [[nodiscard]] Eigen::Index group_count() const {
    return static_cast<Eigen::Index>(groups.size());
  }
};

/// A criterion scores each site for each group of modes; larger is better. The worst group
/// limits the site. Scores do not depend on the sign of a mode or on a rotation of the
/// modes within a group.
struct Criterion {
  std::string_view name;     ///< as a study writes it: criterion = "weakest_mode"
  std::string_view summary;  ///< one line
  std::string_view source;   ///< where it comes from
  std::string_view unit;     ///< of the result of `for_people`
  /// n×g, finite, 0 or more.
  Eigen::MatrixXd (*score)(const PairView& view);
  /// Converts the score to the value that an engineer reads.
  double (*for_people)(double score);
};

/// All criteria, in their order for the user.
[[nodiscard]] std::span<const Criterion* const> criteria();

/// @throws InvalidInput  no criterion has this name; the message lists the names
[[nodiscard]] const Criterion& criterion(std::string_view name);

/// Strength with which the existing pairs and one pair at each site see each group, n×g: the root
/// of the smallest eigenvalue of Σ_c w_c φ(c) φ(c)ᵀ over the modes of the group. `weights` gives
/// w_c ((p + n)×g, existing pairs first). k repeated modes need k pairs. With fewer pairs the
/// result is the root of the mean eigenvalue: the share of one mode if all get equal shares.
[[nodiscard]] Eigen::MatrixXd visibility(const PairView& view, const Eigen::MatrixXd& weights);

/// Standard deviation of ln α of each group, n×g, for gain matching over the pairs (5.5): Var ln
/// β = (σ_s² + σ_a² + 2 σ_p² |∇φ|²) / φ² for one pair, β = α².
[[nodiscard]] Eigen::MatrixXd alpha_deviation(const PairView& view);

}  // namespace chladni::placement
