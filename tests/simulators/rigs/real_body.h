// The bodies of real rigs: a table, a strip, a disc and an L, each with its channels.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "simulators/tables/rig.h"

namespace chladni::simulators {

enum class Outline { rectangle, disc, ell };

/// A body as it is believed to be. Its plate is thin where the outline is no rectangle.
struct RealBody {
  Rig rig;  ///< for a disc and an L, `body` has the sides of the box around them
  Outline outline = Outline::rectangle;
  double mass = 0.0;            ///< [kg], with its fixtures
  double accelerometer = 1e-3;  ///< [kg], usual mass of one on this body

  /// Whether the place lies on the body, at least `margin` [m] from its rim.
  [[nodiscard]] bool covers(const Eigen::Vector2d& place, double margin = 0.0) const;
  [[nodiscard]] double size() const { return rig.body.length; }
};

/// "table": 600 x 600 x 20 mm, aluminium, 13 sensors, 4 actuators. "strip": the strip of
/// rig_named up to 1000 Hz, 5 sensors, 3 actuators. "disc": a glass mirror, 300 mm across, 8 mm
/// thick, 12 sensors, 3 actuators. "ell": 400 x 400 x 8 mm, aluminium, without its quarter at +x
/// and +y, 10 sensors, 3 actuators.
[[nodiscard]] const std::vector<std::string>& real_body_names();

/// @throws InvalidInput  another name
[[nodiscard]] RealBody real_body(const std::string& name);

/// Modes of a body without attachments: rigid-body modes at 0 Hz, then the others, ascending.
struct BareModes {
  Eigen::VectorXd frequency_hz;  ///< n
  Eigen::Index rigid_count = 0;
  /// k×n [kg^-1/2] at the rows of k×2 places [m].
  std::function<Eigen::MatrixXd(const Eigen::MatrixX2d&)> shapes_at;
};

/// The modes of `plate` within an outline: a Ritz plate in a rectangle, else Kirchhoff's cells (a
/// cell on the rim of a disc counts with its share of the area). Cost: 0.3 to 2 s.
[[nodiscard]] BareModes bare_modes(const RitzBody& plate, Outline outline);

/// The modes of a body as it is believed to be. They are kept between calls.
[[nodiscard]] const BareModes& believed_modes(const RealBody& body);

/// The first flexible frequency above the low end of the band [Hz].
[[nodiscard]] double first_in_band(const RealBody& body);

}  // namespace chladni::simulators
