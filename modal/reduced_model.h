// A structure reduced to its channels: some modes, and the flexibility of all others.
#pragma once

#include <Eigen/Core>

namespace chladni::modal {

/// p outputs (displacements), q inputs (forces), m modes, d dashpots.
struct ReducedModel {
  Eigen::VectorXd frequency_hz;   ///< m, ascending; the first rigid_count are exactly 0
  Eigen::VectorXd damping_ratio;  ///< m, fraction of critical
  Eigen::Index rigid_count = 0;
  Eigen::MatrixXd output_shapes;  ///< p×m [kg^-1/2]
  Eigen::MatrixXd input_shapes;   ///< m×q [kg^-1/2]
  Eigen::MatrixXd residual;       ///< p×q [m/N]: static flexibility of the omitted modes; zero
                                  ///< if it is not known

  /// Dashpots at single places. They couple the modes and are therefore separate. Each acts on one
  /// displacement, scaled by the root of its constant c.
  struct Dampers {
    Eigen::MatrixXd shapes;       ///< d×m [kg^-1/2 (N s/m)^1/2]
    Eigen::MatrixXd to_outputs;   ///< p×d, residual flexibility [m/N (N s/m)^1/2]
    Eigen::MatrixXd from_inputs;  ///< d×q, likewise
    Eigen::MatrixXd among;        ///< d×d, likewise [s]: symmetric, positive semidefinite
  } dampers;

  [[nodiscard]] Eigen::Index mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] Eigen::Index output_count() const { return output_shapes.rows(); }
  [[nodiscard]] Eigen::Index input_count() const { return input_shapes.cols(); }
  [[nodiscard]] Eigen::Index damper_count() const { return dampers.shapes.rows(); }
};

/// @throws InvalidInput  the arrays do not fit together, or an entry is not finite
void check(const ReducedModel& model);

}  // namespace chladni::modal
