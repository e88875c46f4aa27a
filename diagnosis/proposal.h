// A further measurement that would tell explanations apart, with its cost.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

namespace chladni::diagnosis {

/// What a measurement costs, as the ln of the Bayes factor that it must bring to be worth its
/// while. The defaults say that a known mass is laid on in minutes, a sensor needs a cable and a
/// channel, and a weighing means a dismount.
struct MeasurementCosts {
  double repetition = 0.5;  ///< a mode measured again
  double exchange = 0.5;    ///< another sensor or actuator in the place of one
  double mass = 1.0;        ///< a known mass on the body
  double dimension = 1.5;   ///< callipers
  double sensor = 2.0;      ///< one more sensor
  double weighing = 4.0;    ///< the body alone on scales
};

/// A measurement, and what it is expected to tell.
struct Proposal {
  enum class What { repetition, exchange, mass, dimension, sensor, weighing };
  What what = What::sensor;
  std::string of;                        ///< what is measured or exchanged: "s3", "the thickness"
  std::optional<Eigen::Vector2d> place;  ///< of the sensor or the mass, on the chart [m]
  double mass = 0.0;                     ///< [kg], of the known mass
  /// Expected ln of the Bayes factor between the best explanation and the rivals that would remain.
  double evidence = 0.0;
  double cost = 0.0;  ///< MeasurementCosts
};

/// A place on the chart [m] as "(120, 40) mm"; below 10 mm with decimals, down to micrometres.
[[nodiscard]] std::string place_in_words(const Eigen::Vector2d& place);
/// "a known mass of 20 g at (120, 40) mm: ln of the Bayes factor about 7".
[[nodiscard]] std::string in_words(const Proposal& proposal);
/// "sensor", "mass", ...
[[nodiscard]] std::string_view name(Proposal::What what);

}  // namespace chladni::diagnosis
