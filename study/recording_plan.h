// How frequency responses are estimated from recordings.
#pragma once

#include <string>

namespace chladni::study {

/// Keys of [measurement] beside `time`.
struct RecordingPlan {
  int period = 0;                    ///< samples of the periodic excitation; 0: as in the file
  double sample_rate_hz = 0.0;       ///< 0: as in the file
  std::string inputs = "commands";   ///< held from sample to sample; or "forces": measured
  std::string transient = "remove";  ///< from all periods; or "drop": the first periods
  double force_window = 0.0;         ///< [s] after a blow; 0: none
  double exponential_window = 0.0;   ///< [s], its time constant; 0: none
  std::string hammer = "h1";         ///< or "h2"
};

}  // namespace chladni::study
