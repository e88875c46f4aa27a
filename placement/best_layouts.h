// The quality of layouts, and the best possible ones.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "placement/candidates.h"
#include "placement/observer_layouts.h"
#include "placement/wanted_modes.h"

namespace chladni::placement {

/// The quality of a layout.
struct LayoutScore {
  Eigen::VectorXd scores;  ///< as `layout_criteria()`; NaN: does not apply
  std::vector<int> blind;  ///< modes that it cannot see, counted from 1 with the rigid ones
  int pairs = 0;           ///< collocated
  /// For each point of the surface: expected error of an interpolated shape, root mean square over
  /// the wanted modes, relative to that of the shape; empty without channels.
  Eigen::VectorXd deviation;
  std::optional<ObserverValue> observer;  ///< where the plan states what is to be known
  /// For each point of the surface [m]: standard deviation of what is not known of its motion, z
  /// along the devices; empty without `observer`.
  Eigen::VectorXd motion_deviation;
};

struct Optimum;

/// Scores layouts of one structure.
class LayoutScorer {
 public:
  /// Structure and surface must live longer.
  LayoutScorer(const Structure& structure, const Sites& surface, WantedModes wanted,
               const Plan& plan);

  /// Some channels of the structure, by index.
  [[nodiscard]] LayoutScore of_channels(const std::vector<std::size_t>& sensors,
                                        const std::vector<std::size_t>& actuators) const;
  /// Sensors at some sites, beside the channels that stay. @param shapes  s×r [kg^-1/2]
  [[nodiscard]] LayoutScore of_sensors(const Eigen::MatrixXd& shapes) const;
  /// The devices of a layout for an observer, beside the channels that stay; `observer` is with all
  /// channels of a kind of which the plan chooses none.
  [[nodiscard]] LayoutScore of_devices(const Optimum& optimum) const;

 private:
  [[nodiscard]] LayoutView view_of(const std::vector<std::size_t>& sensors,
                                   const std::vector<std::size_t>& actuators) const;
  [[nodiscard]] LayoutView view_of_those_that_stay() const;
  [[nodiscard]] LayoutScore scored(LayoutView view, const Eigen::MatrixXd& watched,
                                   const Eigen::MatrixXd& disturbing) const;
  [[nodiscard]] std::vector<int> blind_modes(LayoutView view) const;

  const Structure& structure_;
  const Sites& surface_;
  WantedModes wanted_;
  double frequency_tolerance_;
  DeviceCounts devices_;                           // of the observer's layout
  LayoutView view_;                                // without channels
  std::shared_ptr<const ObserverModel> observer_;  // of the plan's task, or null
};

/// A best layout of sensors, or of the devices of an observer.
struct Optimum {
  std::string by;  ///< the criterion: "determinant", "interpolation_error", "observer_error", ...
  Choice choice;   ///< rows of the candidates; the score of an observer is its variance or cost,
                   ///< less than 0 [m²]
  Points sites;    ///< count×3 [m]
  Eigen::MatrixXd shapes;                 ///< count×r [kg^-1/2], at the sites
  std::vector<Points> equivalent;         ///< equally good, by the symmetry of the body
  double certificate = 0.0;               ///< proven D-efficiency; 0: none
  std::string remark;                     ///< reason for a missing certificate
  std::vector<DeviceKind> kinds;          ///< per site; empty: sensors
  std::optional<ObserverValue> observer;  ///< of "observer_error" and "loop_cost"

  /// Shapes at the sites that sense, or act.
  [[nodiscard]] Eigen::MatrixXd sensing() const { return all_but(DeviceKind::actuator); }
  [[nodiscard]] Eigen::MatrixXd acting() const { return all_but(DeviceKind::sensor); }

 private:
  [[nodiscard]] Eigen::MatrixXd all_but(DeviceKind other) const;
};

/// The best layouts by determinant and by expected interpolation error, and where the plan has a
/// task for an observer by that, beside the channels that stay; the plan's own comes first. A kind
/// of which the observer's layout chooses none is that of the structure: all its actuators disturb
/// where only sensors are chosen.
/// @throws InvalidInput  more sites than candidates; as `best_determinant`
[[nodiscard]] std::vector<Optimum> best_layouts(const Structure& structure, const Sites& surface,
                                                const Candidates& candidates,
                                                const WantedModes& wanted, const Plan& plan,
                                                unsigned seed);

}  // namespace chladni::placement
