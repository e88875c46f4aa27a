// Modes beyond the measured lines: what they add within, and which of them no data can have.
#pragma once

#include <complex>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// Whether a mode lies above or below the lines (Constants::above_band, below_band). Its tail is
/// measured, its resonance is not.
[[nodiscard]] bool is_beyond_lines(const FitData& data, double frequency_hz);

/// Whether the data cannot show a resonance at the pole: it lies Constants::far_beyond from the
/// lines, or its damping ratio is above Constants::no_peak.
[[nodiscard]] bool has_no_resonance(const FitData& data, const std::complex<double>& pole);

/// Whether that is true of a mode of the fit.
[[nodiscard]] bool has_mode_without_resonance(const FitData& data, const ModalFit& fit);

/// Fits again without the modes that have no resonance; such ones stand for errors of the model,
/// and nothing determines their residues. A fit of such modes alone stays.
void drop_modes_without_resonance(const FitData& data, const FitOptions& options, ModalFit& fit);

/// The start and one pole above the lines, where it explains most beside the others. Cost: six
/// linear problems of residues.
[[nodiscard]] Start with_mode_above(const FitData& data, Start start, Damping damping);

/// The start and Constants::modes_above poles above the lines, as many as the data have numbers
/// for.
[[nodiscard]] Start with_modes_above(const FitData& data, Start start, Damping damping);

}  // namespace chladni::identification
