// Criteria for the quality of a set of sensors and actuators.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modal/groups.h"
#include "placement/interpolation.h"
#include "placement/observer_model.h"

namespace chladni::placement {

/// Input of a layout criterion: s sensors, a actuators, m wanted modes in g
/// groups, r modes in total.
struct LayoutView {
  std::vector<modal::ModeGroup> groups;
  Eigen::MatrixXd sensors;                                   ///< s×m [kg^-1/2]
  Eigen::MatrixXd actuators;                                 ///< a×m [kg^-1/2]
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;  ///< sensor and actuator at one place
  Eigen::VectorXd frequency_hz;                              ///< m
  Eigen::VectorXd damping_ratio;                             ///< m; 0 where unknown
  Eigen::VectorXd rms;             ///< m: root mean square of a mode's group on the surface
  Eigen::VectorXd sensor_noise;    ///< m [kg^-1/2]
  Eigen::VectorXd actuator_noise;  ///< m [kg^-1/2]
  ShapePrior prior;
  Eigen::MatrixXd sensors_all;            ///< s×r [kg^-1/2]
  Eigen::MatrixXd actuators_all;          ///< a×r
  Eigen::MatrixXd surface_all;            ///< n×r, points of the surface
  Eigen::MatrixXd interest_all;           ///< k×r, points of interest; may be empty
  Eigen::MatrixXd interest;               ///< k×m
  std::optional<ObserverValue> observer;  ///< of a stated task, with these devices
  Eigen::MatrixXd pair_slopes = {};  ///< p×m [kg^-1/2 m^-1]: along the surface, of each of `pairs`;
                                     ///< may be empty without an error of the position
  double position_error = 0.0;  ///< [m]: standard deviation per axis, of sensor and actuator
};

/// Values are for readers: NaN means that the criterion does not apply (no pair, fewer sites than
/// modes). No value depends on the sign of a mode or on a rotation within a group.
struct LayoutCriterion {
  std::string_view name;     ///< key of `scores` in placement.json
  std::string_view summary;  ///< one line
  std::string_view source;
  std::string_view unit;
  bool larger_is_better;
  double (*value)(const LayoutView& view);
};

[[nodiscard]] std::span<const LayoutCriterion* const> layout_criteria();

/// The shapes at the n_z = n_s + n_a − n_c distinct points (5.2): all sensors, then the actuators
/// without a sensor at their place; relative to each mode's root mean square.
[[nodiscard]] Eigen::MatrixXd observed(const LayoutView& view);

/// The same for all r modes in [kg^-1/2], with the noise of each point for each wanted mode
/// relative to its root mean square. The two samples of a pair count as one with less noise.
struct Samples {
  Eigen::MatrixXd rows;   ///< n_z×r
  Eigen::MatrixXd noise;  ///< n_z×m
};
[[nodiscard]] Samples samples(const LayoutView& view);

/// Per group (g): how strongly all points together see its least visible mode, relative to one
/// point of average motion. Below Constants::blind the layout cannot see it. A point more takes no
/// sight away.
[[nodiscard]] Eigen::VectorXd sight(const LayoutView& view);

/// Places with directions, for the search of pairs: n×3 [m], n×3 (unit).
struct Lines {
  Points position, direction;
};

/// Pairs of sensors and actuators that act along one line: parallel, at most `beside` [m] apart
/// across it and `along` [m] along it (on both faces of a thin body). The nearest are joined
/// first, so that the order of the channels does not matter; pairs are listed by their sensors.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated(const Lines& sensors,
                                                                            const Lines& actuators,
                                                                            double beside,
                                                                            double along);

}  // namespace chladni::placement
