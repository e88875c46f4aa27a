// The common data type of all rooms: modes on a set of degrees of freedom.
#pragma once

#include <Eigen/Core>

namespace chladni::modal {

/// m modes at n degrees of freedom, computed or measured.
struct Modes {
  Eigen::VectorXd frequency_hz;   ///< m, ascending; rigid-body modes come first, exactly 0
  Eigen::VectorXd damping_ratio;  ///< m, fraction of critical; 0 where unknown
  Eigen::MatrixXd shapes;         ///< n×m [kg^-1/2], mass-normalised: φᵀMφ = 1
  Eigen::Index rigid_count = 0;   ///< number of rigid-body modes; they come first

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index dof_count() const { return shapes.rows(); }
};

}  // namespace chladni::modal
