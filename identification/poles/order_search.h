// The number of modes: which of a fit are left out, and which are added.
#pragma once

#include "identification/fit_data.h"
#include "identification/identified.h"

namespace chladni::identification {

/// Whether a fit with more modes is worth its parameters: the Bayesian information criterion, and
/// Constants::least_decrease where the noise is not known.
[[nodiscard]] bool pays(const FitData& data, const ModalFit& before, const ModalFit& after);

/// Whether a fit explains more than another, for its parameters.
[[nodiscard]] bool is_better(const FitData& data, const ModalFit& one, const ModalFit& other);

/// Whether the data ask for no further mode. Modes far beyond the lines end where little more than
/// noise is left: what remains is no mode of the structure.
[[nodiscard]] bool is_enough(const FitData& data, const IdentificationOptions& options,
                             const ModalFit& fit);

/// Leaves out modes without worth once the poles are the most likely ones. Such a pole was never a
/// mode: it corrected errors that the vector fit had left in its neighbours.
void drop_idle_modes(const FitData& data, const FitOptions& options, Identified& result);

/// Adds the mode that explains most of what is left, as long as more than noise is left and the
/// mode pays; up to options.modes where they are given.
void add_missing_modes(const FitData& data, const IdentificationOptions& options,
                       Identified& result);

/// Leaves out one of two complex modes at one pole, whose shapes nothing determines, if that costs
/// less than its parameters.
void drop_doubled_modes(const FitData& data, const FitOptions& options, Identified& result);

/// Fits modes above the lines where a search within them left more than noise. A vector fit seeks
/// poles within the lines, and a constant has no slope: else modes that are not there stand for the
/// slope that the modes above leave. Such modes are broad, and are left out if others explain as
/// much. At the end doubtful modes within are exchanged for some above, or left out, if what is
/// left is near the noise. Cost: two to four fits, one for each mode that is left out, and two for
/// each that is added or exchanged.
/// @param start  of the search
void look_above_lines(const FitData& data, const Start& start, const IdentificationOptions& options,
                      Identified& result);

}  // namespace chladni::identification
