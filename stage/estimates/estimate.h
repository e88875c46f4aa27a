// Data about a study before the long step: the first line, and the cost of the step.
#pragma once

#include <string>

#include "fem/material.h"
#include "stage/body.h"
#include "study/study.h"

namespace chladni::stage {

struct Understood {
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();  ///< of the bounding box
  Eigen::Vector3d sides_m = Eigen::Vector3d::Zero();   ///< however it is turned, the longest first
  double volume_m3 = 0.0;
  double mass_kg = 0.0;             ///< each region with its own material
  fem::Material material = {};      ///< of the largest region
  double first_frequency_hz = 0.0;  ///< flexible, free body; within a factor of two if ribbed
  std::string estimate_name;        ///< "plate", "beam", "disc", "ring" or "box"
  bool is_held = false;             ///< by supports: the estimate is still of the free body
  /// "600.0 x 600.0 x 20.0 mm  19.44 kg  first plate estimate 186 Hz"
  [[nodiscard]] std::string line() const;
};

/// Formulas for free bodies: a rectangular plate by its first twist (Leissa 1973: 13.49 for a
/// square) or bending, a beam by Euler and Bernoulli (22.373), a disc by its (2, 0) mode (Leissa
/// 1969: 5.253), a ring by a mean of that of the disc and that of a slender ring (Love 1944, 293),
/// out of its plane or in it; any other body as the plate of its length, width and volume. All are
/// of thin bodies, without shear: too high by up to a fifth where the height is a fifth of the
/// diameter.
[[nodiscard]] Understood understood(const study::Study& study, const Outline& outline);

struct Cost {
  double degrees_of_freedom = 0.0;
  double memory_bytes = 0.0;               ///< at the peak
  double memory_beside_ranks_bytes = 0.0;  ///< of this process where ranks find the modes
  double seconds = 0.0;                    ///< of one present-day core
  int order = 0;                           ///< of the elements
  bool exact = false;  ///< the mesh is known, not estimated from volume and edge length
  [[nodiscard]] std::string line() const;
};

/// Forecast fitted to plates and tables of 2e4 to 4e5 degrees of freedom of order 2 and 3. For 7 of
/// them the memory is right within 15 %, the time within 25 % on the machine of these runs.
[[nodiscard]] Cost forecast(const study::Study& study, const Outline& outline);

/// Warnings about a body that cannot be a wafer stage: "the body is 600 m long".
[[nodiscard]] std::vector<std::string> implausible(const Understood& understood);

}  // namespace chladni::stage
