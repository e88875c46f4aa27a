// Units of measured responses.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/frf_file.h"

namespace chladni::io {

/// A unit of a motion or a force, from a word.
struct MotionUnit {
  std::string si;       ///< "m", "m/s", "m/s^2", "N"; the word itself for other units
  double factor = 1.0;  ///< SI per word
  std::optional<modal::FrfKind> kind;  ///< for a motion
};

/// The unit "mm", "in/s", "g" (9.80665 m/s²); none where the word is no unit of displacement,
/// velocity or acceleration.
[[nodiscard]] std::optional<MotionUnit> motion_unit(std::string_view word);

/// As `motion_unit`, of a word by which the user states what a file does not: also in brackets,
/// "[mm]". A unit of another kind of sensor ("V", "Pa") is kept with the factor 1, and so is "".
/// kEachInSi stands without brackets and gives "", too.
/// @throws InvalidInput  the word is no unit of what sensors give
[[nodiscard]] MotionUnit stated_unit(std::string_view word);

/// Newtons per `word`; none where the word is no unit of force.
[[nodiscard]] std::optional<double> force_unit(std::string_view word);

/// Converts channels with a unit of motion (outputs) or force (inputs) to SI. The unit states the
/// kind. @param kind_known  the file states the kind too
/// @throws InvalidInput  kind and unit contradict each other
void bring_to_si(FrfFile& file, bool kind_known);

/// Converts the outputs without a unit to SI by `options.unit`. Without that option, it notes that
/// no unit is stated and which kind is assumed. @param kind_known  the file states the kind
/// @throws InvalidInput  the unit is of a motion other than `options.kind`, or none that is known
void state_units(FrfFile& file, bool kind_known, const FrfOptions& options);

}  // namespace chladni::io
