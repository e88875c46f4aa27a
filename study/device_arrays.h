// Arrays of sensors, actuators and attachments: at = { ring = { count = 12, radius = "85 mm" } }.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/problems.h"
#include "study/schema.h"
#include "study/study.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

struct RingPlan {
  int count = 0;
  double radius = 0.0;                               ///< [m]
  double start = 0.0;                                ///< angle of the first from x [rad]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
};

/// A triangular lattice within a hexagon: one in the centre and `rings` around it.
struct HexagonPlan {
  int rings = 0;
  double pitch = 0.0;                                ///< [m]
  double start = 0.0;                                ///< angle of a corner from x [rad]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
};

/// Two springs at a ball in a groove: along z, and across the groove.
struct MountPlan {
  double stiffness = 0.0, lateral_stiffness = 0.0;  ///< [N/m]; lateral 0: as stiffness
  double damping = 0.0, lateral_damping = 0.0;      ///< [N s/m]
  double footprint = 0.0;                           ///< [m]
};

/// A round pad of uniform stiffness.
struct AirBearingPlan {
  double stiffness = 0.0, damping = 0.0;  ///< of the pad along its direction [N/m], [N s/m]
  double diameter = 0.0;                  ///< [m]
};

[[nodiscard]] const Schema<RingPlan>& ring_schema();
[[nodiscard]] const Schema<HexagonPlan>& hexagon_schema();
[[nodiscard]] const Schema<MountPlan>& mount_schema();
[[nodiscard]] const Schema<AirBearingPlan>& air_bearing_schema();

/// Counter-clockwise from `start`.
[[nodiscard]] std::vector<Eigen::Vector2d> places(const RingPlan& plan);
/// The centre, then ring by ring counter-clockwise from `start`: 1 + 3 rings (rings + 1) places.
[[nodiscard]] std::vector<Eigen::Vector2d> places(const HexagonPlan& plan);
/// Along x first, from the smallest x and y.
[[nodiscard]] std::vector<Eigen::Vector2d> places(const GridPlan& plan);

/// Replaces arrays of [[sensor]], [[actuator]] and [[attachment]] by their elements: "s" becomes
/// "s1", "s2", ..., a `node` is counted on. Kinds "kinematic_mount" and "air_bearing" become
/// springs. A later element with the name of one that came from an array changes or removes it.
/// The name of an array stands for all of its elements in [[layout]] and in measurement.hold_out.
/// @param resolved  the place of a CSV file; throws InvalidInput where it may not be read
/// @param files     gets the CSV files that were read
/// Returns true if anything was replaced.
bool expand_arrays(TomlNode& document,
                   const std::function<std::filesystem::path(const std::string&)>& resolved,
                   Problems& problems, std::vector<std::filesystem::path>& files);

}  // namespace chladni::study
