// Frequency responses from blows of a hammer: spectra averaged over hits, one input at a time.
#pragma once

#include <string>
#include <vector>

#include "modal/frf_set.h"
#include "recordings/recordings.h"
#include "recordings/time_data.h"

namespace chladni::recordings {

struct HammerOptions {
  /// The force counts for this time after its peak, then fades over a quarter of this time; 0:
  /// always. The window keeps noise of the force sensor out.
  double force_window_s = 0.0;
  /// Both channels are multiplied by e^{−t/τ} so that they end at rest; 0: no
  /// window. See added_decay.
  double exponential_s = 0.0;
  double low_hz = 0.0, high_hz = 0.0;  ///< high 0: up to half the sampling frequency
};

/// Auto and cross spectra S over the n hits of each input (record.experiment: its index from 0).
struct HammerEstimate {
  modal::FrfSet h1;  ///< S_fy / S_ff: noise on the force makes it smaller by 1 + S_nn/S_ff
  modal::FrfSet h2;  ///< S_yy / S_yf: noise on the response makes it larger by 1 + S_mm/S_yy
  /// [rad/s] Exact decay that the exponential window adds to every mode: both spectra are those at
  /// s = jω + added_decay. Fitted poles are correct after true_poles().
  double added_decay = 0.0;
  std::vector<std::string> notes;  ///< double hits, responses that do not end at rest, one hit only
};

/// Both sets hold the coherence |S_fy|² / (S_ff S_yy). From two hits on they also hold the variance
/// |H|² (1 − γ²) / (γ² (n−1)) (Bendat and Piersol, Random Data, 4th ed., section 9.2). With few
/// hits the power that the force does not explain is averaged over up to 11 lines.
/// @throws InvalidInput  no output or no input, records of unequal length, an input without a hit
///                       or of no force, the band without lines
[[nodiscard]] HammerEstimate hammer_estimate(const TimeData& data,
                                             const HammerOptions& options = {});

/// As that of recordings in memory, with the same bits, of such that may be larger than it.
/// Memory: the samples of one record and its spectra, and sums on all lines.
/// @throws InvalidInput  as that, or there is no record
[[nodiscard]] HammerEstimate hammer_estimate(const Recordings& recordings,
                                             const HammerOptions& options = {});

/// Removes the window's decay from poles [rad/s] that were fitted to windowed responses.
/// @throws InvalidInput  a pole grows: the fit found less damping than the window adds
[[nodiscard]] Eigen::VectorXcd true_poles(const Eigen::VectorXcd& fitted, double added_decay);

}  // namespace chladni::recordings
