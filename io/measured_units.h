// Units of motions and forces, as programs spell them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modal/frf_set.h"

namespace chladni::io {

/// A unit of a motion or a force, from a word.
struct MotionUnit {
  std::string si;       ///< "m", "m/s", "m/s^2", "N"; the word itself for other units
  double factor = 1.0;  ///< SI per word
  std::optional<modal::FrfKind> kind;  ///< for a motion
};

/// How many `si` one `unit` is; none where it is no unit of this kind.
[[nodiscard]] std::optional<double> factor_of(const std::string& unit, const std::string& si);

/// A unit without blanks and without the brackets around the whole of it: "mm" of "[mm]" and of
/// " (mm)", "(m)/(N)" as it is. Brackets within it are round ones, "(m/s)/N" of "[m/s]/N", and a
/// power is "^": "m/s^2" of "m/s**2". A word of more than 64 letters, which is no unit, is as it
/// is.
[[nodiscard]] std::string bare_unit(std::string_view word);

/// The unit "mm", "in/s", "g" (9.80665 m/s²), "mg" (a thousandth of it); none where the word is no
/// unit of displacement, velocity or acceleration.
[[nodiscard]] std::optional<MotionUnit> motion_unit(std::string_view word);

/// Newtons per `word`, which may be in brackets and in capitals, "(LBF)"; "lb" and "lbs" are forces
/// here. None where the word is no unit of force.
[[nodiscard]] std::optional<double> force_unit(std::string_view word);

/// The unit of a motion over a force, "g/lbf", "um N^-1": that of the motion, and SI per word,
/// where the force is in newtons. None where the word is no such unit.
[[nodiscard]] std::optional<MotionUnit> response_per_newton(const std::string& word);

}  // namespace chladni::io
