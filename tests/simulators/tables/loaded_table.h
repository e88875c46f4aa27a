// The wafer table with a mass on it, damped as in a hammer test: every mode of table and mass
// together has the same damping ratio.
#pragma once

#include "modal/frf_set.h"
#include "simulators/plates/ritz_plate.h"

namespace chladni::simulators {

struct LoadedTable {
  double mass = 0.0;                                ///< [kg]
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< [m]
  double spring = 0.0;                              ///< [N/m], to ground
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();   ///< [m]: of the spring
  double damping_ratio = 5e-3;                      ///< of each mode that is not rigid
  double damping_spread = 0.0;                      ///< of its logarithm, drawn for each mode
  double noise = 3e-3;  ///< circular, relative to |G| of the line and response and to its median
  int lines = 160;
  double low_hz = 20.0, high_hz = 900.0;
  unsigned seed = 1;
};

/// Receptances Σ_k φ_k(s) φ_k(a) / (ω_k² − ω² + 2jζω_kω) of table_channels() over all modes of the
/// loaded plate, with their variances. Independent of ritz_response.h, which damps the bare plate.
/// Cost: n³ of the plate's modes, some ms per line.
/// @throws InvalidInput  a place off the plate
[[nodiscard]] modal::FrfSet loaded_table(const RitzModes& plate, const LoadedTable& table);

}  // namespace chladni::simulators
