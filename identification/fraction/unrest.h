// Whether the iteration of Sanathanan and Koerner settles.
#pragma once

#include <string>
#include <vector>

namespace chladni::identification {

/// Largest output error of the last half of the iterates over `least`; infinite where one of them
/// is not finite. 1 without iterates.
/// @param costs  output error of each iterate
/// @param least  the least of them, or what noise leaves if that is more; above 0
[[nodiscard]] double unrest_of(const std::vector<double>& costs, double least);

/// What is said of an iteration that does not settle.
[[nodiscard]] std::string unrest_note(double unrest);

}  // namespace chladni::identification
