// What measurements are made on: a body, what it carries and hangs on, where it is driven and seen.
#pragma once

#include <string>
#include <vector>

#include "simulators/ritz_plate.h"
#include "simulators/table_channels.h"

namespace chladni::simulators {

/// How large what is hidden is on a rig, over what it is on the wafer table.
struct RigScale {
  double mass = 1.0, length = 1.0, frequency = 1.0;

  [[nodiscard]] double stiffness() const { return mass * frequency * frequency; }
  [[nodiscard]] double damping() const { return mass * frequency; }
};

/// As everybody believes it to be.
struct Rig {
  std::string name;
  RitzBody body;
  TableChannels channels;
  bool driven_from_below = false;         ///< actuators and fixed masses are on the lower face
  double damping_ratio = 5e-3;            ///< of each mode
  double low_hz = 20.0, high_hz = 900.0;  ///< of the lines
  RigScale scale;
  std::vector<std::string> without;  ///< kinds that are something else here, or nothing

  /// Longer than eight times its width: everything moves and hangs along its middle line.
  [[nodiscard]] bool is_slender() const { return body.length > 8.0 * body.width; }
  [[nodiscard]] bool has(const std::string& kind) const;
};

/// "table": the wafer table, 4 sensors and 13 actuators of models/oat/minimal; "table_few": the
/// same with 3 sensors and 5 actuators at odd places; "strip": the steel strip of models/beam (500
/// x 20 x 2 mm) on its flexures, with three coils of 31 g, 5 sensors and 3 actuators; "strip_few":
/// the same with 3 sensors beside the coils.
[[nodiscard]] const std::vector<std::string>& rig_names();

/// @param degree  of the polynomials along a side of the table; a strip has ten more along it, and
///                five across
/// @throws InvalidInput  another name
[[nodiscard]] Rig rig_named(const std::string& name, int degree = 14);

/// The study that somebody writes of it, as TOML: no measurements, the default mesh.
/// What holds a strip along the directions in which it is not measured is soft (a few Hz).
/// @param edge_length  of the mesh [m]; 0: left to the program
[[nodiscard]] std::string study_text(const Rig& rig, double edge_length = 0.0);

}  // namespace chladni::simulators
