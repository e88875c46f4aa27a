// Channels that are read in a wrong way: sign, unit, quantity and delay, all of them together.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// What decides about readings.
struct ReadingNumbers {
  /// [1] BandPair::distance at most, in the median over a channel's responses, of a reading that is
  /// believed: then the model explains three quarters of the averages. Chosen.
  double most_distance = 0.25;
  /// [periods] Delays that are tried, at the highest line: from the shortest to the longest, and
  /// their step. Chosen: a fit goes on from a tenth of a turn, and modes that are off by 2 % may
  /// look like a delay of 0.05.
  double shortest_delay = 0.15, longest_delay = 1.0, delay_step = 0.05;
  /// [1] All frequencies of the model are also tried off by up to so much, in steps. Chosen: a
  /// modulus that is off by 25 %.
  double most_shift = 0.12, shift_step = 0.04;
};

/// The wrong readings of all channels, as effects of the catalogue: sensor_sign, actuator_sign,
/// sensor_unit, sensor_quantity, delay, sensor_delay, actuator_delay. Measured responses and those
/// of the structure as it is are averaged over bands (bands.h). For each channel, and for all
/// sensors together, all signs × units × quantities × delays are tried at once, so that two or
/// three that are wrong together are found, where each by itself explains nothing. A reading needs
/// the evidence of a cause for each of its parts, in averages whose model-form error is learned.
/// The channel with most evidence is put right, then the next one is sought. One response suffices.
/// Frequencies that are all off (a modulus) are allowed for. Delays of a tenth of a period and less
/// are left to the search. Cost: the responses once, if nothing is wrong; 0.1 to 1 s for 52
/// responses of 320 lines else.
/// @param catalogue  effects that may be named
/// @return starts for a search; empty where nothing is wrong
[[nodiscard]] std::vector<Supposed> readings(const Problem& problem,
                                             const std::vector<const Effect*>& catalogue);

/// The fit of these readings, in full, with the tolerances from 0. None where there are no
/// readings, where they bring less than `least_evidence` beyond `nothing`, or where no fit is
/// possible.
[[nodiscard]] std::optional<Fit> fitted_with_readings(const Problem& problem,
                                                      const std::vector<const Effect*>& catalogue,
                                                      const Fit& nothing, double least_evidence);

/// The fit of `best` with those of the readings that it lacks, from its tolerances: a reading may
/// have been lost because the fit with it had stopped in another minimum. None if that brings less
/// than `least_evidence`.
[[nodiscard]] std::optional<Fit> fitted_with_lost(const Problem& problem,
                                                  const std::vector<Supposed>& read,
                                                  const Fit& best, double least_evidence);

}  // namespace chladni::diagnosis
