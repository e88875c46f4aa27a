// Rigs for measurements: a body with its fixtures, suspension, actuators and sensors.
#pragma once

#include <string>
#include <vector>

#include "simulators/plates/ritz_plate.h"
#include "simulators/tables/table_channels.h"

namespace chladni::simulators {

/// The scale of hidden effects on a rig, relative to the wafer table.
struct RigScale {
  double mass = 1.0, length = 1.0, frequency = 1.0;

  [[nodiscard]] double stiffness() const { return mass * frequency * frequency; }
  [[nodiscard]] double damping() const { return mass * frequency; }
};

/// A rig as it is believed to be.
struct Rig {
  std::string name;
  RitzBody body;
  TableChannels channels;
  bool driven_from_below = false;         ///< actuators and fixed masses are on the lower face
  double damping_ratio = 5e-3;            ///< of each mode
  double low_hz = 20.0, high_hz = 900.0;  ///< first and last line
  RigScale scale;
  /// The geometry of the study as TOML, such as { disc = { ... } }; empty: the sides of `body`.
  std::string geometry;
  std::string surface;  ///< text of the OFF file "body.off" that `geometry` uses; empty: none
  std::vector<std::string> without;  ///< kinds that do not exist or mean something else here

  /// Whether the body is longer than eight times its width. Everything then lies on its middle
  /// line.
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

/// The study of a rig as a user writes it, as TOML, without measurements and with the default mesh.
/// Soft springs (a few Hz) hold a strip along the directions that are not measured.
/// @param edge_length  of the mesh [m]; 0: the program chooses it
[[nodiscard]] std::string study_text(const Rig& rig, double edge_length = 0.0);

}  // namespace chladni::simulators
