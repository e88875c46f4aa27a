// Units of measured responses.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/frf_file.h"

namespace chladni::io {

/// What a word says of a motion or a force.
struct MotionUnit {
  std::string si;       ///< "m", "m/s", "m/s^2", "N"; the word itself where it is none of these
  double factor = 1.0;  ///< SI per word
  std::optional<modal::FrfKind> kind;  ///< of a motion
};

/// "mm", "in/s", "g" (9.80665 m/s²); none where it is no unit of a length over time.
[[nodiscard]] std::optional<MotionUnit> motion_unit(std::string_view word);

/// Newtons per `word`, none where it is no unit of force.
[[nodiscard]] std::optional<double> force_unit(std::string_view word);

/// Puts what has a unit of motion (outputs) or force (inputs) into SI; the unit says the kind.
/// @param kind_known  the file says the kind too
/// @throws InvalidInput  kind and unit contradict each other
void bring_to_si(FrfFile& file, bool kind_known);

/// Puts the outputs that have no unit into SI by `options.unit`, or notes that none is stated, and
/// of which kind they are then taken to be. @param kind_known  the file says the kind
/// @throws InvalidInput  the unit is of a motion other than `options.kind`
void state_units(FrfFile& file, bool kind_known, const FrfOptions& options);

}  // namespace chladni::io
