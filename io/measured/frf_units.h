// Units of measured responses.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/frf_file.h"
#include "io/measured_units.h"

namespace chladni::io {

/// "m", "m/s" or "m/s^2".
[[nodiscard]] std::string si_unit_of(modal::FrfKind kind);

/// As `motion_unit`, of a word by which the user states what a file does not: also in brackets,
/// "[mm]". A unit of another kind of sensor ("V", "Pa") is kept with the factor 1, and so is "".
/// kEachInSi stands without brackets and gives "", too.
/// @throws InvalidInput  the word is no unit of what sensors give
[[nodiscard]] MotionUnit stated_unit(std::string_view word);

/// The unit of a motion over a newton in one word, "um N^-1", "m/(s^2 N)"; none where it is none.
[[nodiscard]] std::optional<MotionUnit> unit_over_newton(const std::string& word);

/// Whether a word is a unit of a motion over a force: "g/lbf", "um N^-1".
[[nodiscard]] bool is_response_unit(const std::string& word);

/// Whether a unit stands in a product of units: "kN" in "um kN^-1", but no "N".
[[nodiscard]] bool stands_in(std::string_view unit, std::string_view word);

/// Whether a word is a unit of what sensors give, of a force, or of a motion over a force: "mm",
/// "V", "lbf", "um/N".
[[nodiscard]] bool is_measured_unit(const std::string& word);

/// Notes that the unit of an input is none that is known, so that nothing converted its values.
void note_unknown(const modal::MeasuredChannel& input, std::vector<std::string>& notes);

/// Notes that the unit of an output is none that is known.
void note_unknown_output(const modal::MeasuredChannel& output, std::vector<std::string>& notes);

/// Notes that `unit`, which the user states, is not used, where all outputs have one in the file.
void note_unused(const std::string& unit, const std::vector<modal::MeasuredChannel>& outputs,
                 std::vector<std::string>& notes);

/// Converts channels with a unit of motion (outputs) or force (inputs) to SI. The unit states the
/// kind. An output may have that of its responses, "um/N": the force is that of the inputs.
/// @param kind_known  the file states the kind too
/// @throws InvalidInput  kind and unit, or the forces, contradict each other
void bring_to_si(FrfFile& file, bool kind_known);

/// Converts the outputs without a unit to SI by `options.unit`. Without that option, it notes that
/// no unit is stated and which kind is assumed. @param kind_known  the file states the kind
/// @throws InvalidInput  the unit is of a motion other than `options.kind`, or none that is known
void state_units(FrfFile& file, bool kind_known, const FrfOptions& options);

}  // namespace chladni::io
