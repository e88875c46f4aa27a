// What an observer of a region will know of its motion: the Kalman filter of a layout, and the loop
// that stands on it.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <utility>
#include <vector>

#include "modal/disturbed_model.h"

namespace chladni::placement {

/// A random disturbance that enters the modes in a way that no layout changes.
struct FixedDisturbance {
  Eigen::RowVectorXd shape;   ///< r: modal force over its unit [kg^-1/2], of the floor [kg^1/2]
  modal::Disturbance course;  ///< its `input` is not used
};

/// The motion z that is wanted, what disturbs it, and what sees it: r modes.
struct ObserverTask {
  Eigen::VectorXd frequency_hz;       ///< r, ascending, rigid-body modes first
  Eigen::VectorXd damping_ratio;      ///< r, above 0 of the flexible ones
  Eigen::Index rigid_count = 0;       ///< of modes that `suspension_hz` holds
  double suspension_hz = 1.0;         ///< below the first flexible mode
  double frequency_tolerance = 0.01;  ///< relative: closer neighbours get one frequency and damping
  Eigen::MatrixXd region;  ///< r×r: mean of ψ ψᵀ over the region [kg^-1], ψ the shapes along z
  std::vector<FixedDisturbance> fixed;
  std::vector<modal::Disturbance> at_actuators;  ///< independent, at each actuator of a layout
  double sensor_rms = 0.0;                       ///< [m], of each sensor in each sample
  double sample_time_s = 0.0;
  double effort = 0.0;  ///< [m/N]: motion that a force of 1 N of one actuator is worth; 0: no loop
};

/// What can be known and held of z in steady state: means over the region.
struct ObserverValue {
  double estimate = 0.0;    ///< [m²]: variance of the estimate with this sample's sensors
  double prediction = 0.0;  ///< [m²]: with those before it alone
  double without = 0.0;     ///< [m²]: of z under the disturbances, without sensors and loop
  /// [m²]: mean square of z and of (effort · force), summed over the actuators, in the best loop:
  /// by the estimate from the samples before, or with the states known where there is no sensor.
  double loop = std::numeric_limits<double>::quiet_NaN();
  double loop_motion = std::numeric_limits<double>::quiet_NaN();    ///< [m²]: z's part of it
  double loop_force_n2 = std::numeric_limits<double>::quiet_NaN();  ///< [N²]: all forces'
  /// r×r [kg m²]: covariance of the error of the modal coordinates, this sample's sensors included.
  Eigen::MatrixXd coordinates;
};

/// The sampled model of a task. States are scaled to about 1: positions and velocities of modes,
/// then those of the disturbances. Rigid-body modes have no stiffness of their own. They get the
/// frequency `suspension_hz` and a damping ratio of 0.7: an integrator that a layout does not see
/// has no bound, and layouts could not be compared. For the same reason a drift forgets its level
/// in a hundred of its times.
class ObserverModel {
 public:
  /// Cost: one matrix exponential for each course of a disturbance.
  /// @throws InvalidInput  arrays that do not fit, no disturbance, no noise of the sensors, no
  /// sample
  ///                       time, an undamped mode, an empty region, a suspension that is not below
  ///                       the first flexible mode; as modal::disturbed_model
  explicit ObserverModel(const ObserverTask& task);

  /// Under the disturbances, those of actuators at some places.
  struct Disturbed {
    Eigen::MatrixXd a;      ///< n×n
    Eigen::MatrixXd noise;  ///< n×w: what a deviation of each noise does
    [[nodiscard]] Eigen::MatrixXd q() const { return noise * noise.transpose(); }
  };
  /// @param actuators  a×r [kg^-1/2]
  [[nodiscard]] Disturbed disturbed(const Eigen::MatrixXd& actuators) const;

  // In the states of `disturbed` with n states.
  /// s×n: what sensors see over their noise. @param shapes  s×r [kg^-1/2]
  [[nodiscard]] Eigen::MatrixXd seen(const Eigen::MatrixXd& shapes, Eigen::Index n) const;
  /// n×a: what a held force of 1 N / effort does. @param shapes  a×r
  [[nodiscard]] Eigen::MatrixXd moved(const Eigen::MatrixXd& shapes, Eigen::Index n) const;
  /// n×n: mean of z² over the region is xᵀ W x [m²].
  [[nodiscard]] Eigen::MatrixXd weight(Eigen::Index n) const;

  /// By the Riccati equations (SLICOT). Cost: that of dense::prediction_covariance, twice with a
  /// loop.
  /// @param sensors    s×r [kg^-1/2]; none: nothing is seen
  /// @param actuators  a×r: where disturbances of actuators act, and the loop
  [[nodiscard]] ObserverValue value(const Eigen::MatrixXd& sensors,
                                    const Eigen::MatrixXd& actuators) const;

  [[nodiscard]] bool has_loop() const { return effort_ > 0.0; }
  [[nodiscard]] Eigen::Index mode_count() const { return region_.rows(); }

 private:
  // A course of disturbances on modes of shape 1: its states, and what they do to the modes.
  struct Course {
    Eigen::MatrixXd a;         // s×s
    Eigen::VectorXd b;         // s
    Eigen::MatrixXd on_modes;  // 2r×s
    Eigen::VectorXd at_once;   // 2r
  };

  struct Filter;

  [[nodiscard]] Filter filtered(const Disturbed& system, const Eigen::MatrixXd& sensors) const;
  [[nodiscard]] Course sampled(const modal::Disturbance& course, const ObserverTask& task) const;
  [[nodiscard]] Eigen::MatrixXd coordinates(Eigen::Index n) const;

  Eigen::MatrixXd modes_;   // 2r×2r: A of the modes, scaled
  Eigen::MatrixXd read_;    // r×2r: modal coordinates of the scaled states
  Eigen::VectorXd held_;    // 2r: what a held unit force of shape 1 does
  Eigen::VectorXd scale_;   // 2r: deviations of the states
  Eigen::MatrixXd region_;  // r×r
  std::vector<std::pair<Eigen::RowVectorXd, Course>> fixed_;
  std::vector<Course> at_actuators_;
  double sensor_rms_ = 0.0, effort_ = 0.0;
};

/// Standard deviation of the estimate at each of k places [m].
/// @param coordinates  of an ObserverValue; @param places  k×r [kg^-1/2]
[[nodiscard]] Eigen::VectorXd estimate_deviation(const Eigen::MatrixXd& coordinates,
                                                 const Eigen::MatrixXd& places);

}  // namespace chladni::placement
