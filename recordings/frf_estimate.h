// Frequency responses from a periodic experiment in open loop. Their uncertainty has two parts:
// noise and nonlinearity (thesis (4.2); the robust method of Pintelon and Schoukens, System
// Identification, 2nd ed. 2012, section 4.3).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "modal/frf_set.h"
#include "recordings/estimate/transfer.h"
#include "recordings/estimate/transient.h"
#include "recordings/spectra.h"

namespace chladni::recordings {

struct FrfEstimateOptions {
  /// The transient of the start is taken off all periods, and none is dropped (local_transient.h).
  /// For recordings: spectra have lost what lies between their lines.
  bool remove_transient = false;
  std::optional<Eigen::Index> drop = {};  ///< periods at the start; none: transient() decides
  double low_hz = 0.0, high_hz = 0.0;     ///< high 0: all excited lines
  /// Variances are averaged over this number of lines on each side (estimate/line_variance.h).
  /// None: enough lines that a variance has 14 degrees of freedom, at most 5 (a weight with few
  /// degrees costs efficiency).
  std::optional<Eigen::Index> smooth_lines = {};
};

struct FrfEstimate {
  modal::FrfSet set;  ///< variance, noise_variance and averages filled where they are known
  Eigen::Index dropped = 0, periods = 0, realisations = 0;  ///< periods: used
  TransientReport transient;
  std::vector<std::string> notes;  ///< what a reader must know: one period only, aliasing, ...
};

/// On the excited lines: G = mean_r Y_r U_r⁻¹ over realisations r. For several inputs U_r is the
/// input matrix of q or more experiments. With one realisation the whole variance counts as noise.
/// @throws InvalidInput  as spectra() and transfer(); the data come from a loop and the inputs were
///                       not excited themselves
[[nodiscard]] FrfEstimate frf_estimate(const Spectra& spectra,
                                       const FrfEstimateOptions& options = {});
/// The same on lines that are all excited, from one realisation after the other.
[[nodiscard]] FrfEstimate frf_estimate_of_excited(const SpectraSource& excited,
                                                  const FrfEstimateOptions& options);
/// @throws InvalidInput  also as without_start(), where the transient is to be removed
[[nodiscard]] FrfEstimate frf_estimate(const TimeData& data,
                                       const FrfEstimateOptions& options = {});

/// The spectra of recordings that the options ask for, and the options for them. `about` receives
/// the transient that was seen before anything was done about it.
/// @throws InvalidInput  as spectra(); no output or no input
[[nodiscard]] std::pair<Spectra, FrfEstimateOptions> prepared(const TimeData& data,
                                                              const FrfEstimateOptions& options,
                                                              TransientReport& about);

/// States what was done: true periods, and the transient that was taken off.
/// @param periods  the fewest of a record
void tell_removed(Eigen::Index periods, const TransientReport& about, FrfEstimate& estimate);
void tell_removed(const TimeData& data, const TransientReport& about, FrfEstimate& estimate);

/// Periods at the start without which a trend is looked for: no transient is left then.
[[nodiscard]] Eigen::Index first_steady_period(const FrfEstimate& estimate);

/// The excited lines of the band, by their places in `all`. @throws InvalidInput  none
[[nodiscard]] std::vector<Eigen::Index> excited_places(const SpectraSource& all,
                                                       const FrfEstimateOptions& options);
[[nodiscard]] Spectra excited_part(const Spectra& all, const FrfEstimateOptions& options);

/// Lines on each side over which a variance of so many degrees of freedom is averaged.
[[nodiscard]] Eigen::Index lines_for_freedom(Eigen::Index freedom);

/// Fills lines, variances (averaged over lines) and their degrees of freedom; the closed loop uses
/// it as well. @pre the set has its values
void fill(const Spectra& spectra, const TransferVariances& found, const FrfEstimateOptions& options,
          FrfEstimate& estimate);

}  // namespace chladni::recordings
