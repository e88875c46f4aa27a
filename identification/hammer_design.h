// A hammer test that measures given modes well enough: where to hit, how often, and what to expect.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/progress.h"
#include "identification/experiment_design.h"

namespace chladni::identification {

struct HammerPlan {
  double sample_time_s = 0.0;
  double low_hz = 0.0, high_hz = 0.0;
  Eigen::VectorXd sensor_noise;        ///< p: rms per sample, white, in the sensor's unit
  double force_limit_n = kNoLimit;     ///< peak of a blow
  double pulse_s = 0.0;                ///< of a blow; 0: the longest that reaches the band's end
  double frequency_std_hz = kNoLimit;  ///< wanted
  double damping_std = 0.05;           ///< wanted, relative
  double longest_s = 1800.0;           ///< of all blows with their records
  double longest_record_s = 120.0;
  double pause_s = 5.0;  ///< between a record and the next blow
};

/// A blow is half a sine: F(f) = 2Aτ/π · cos(πfτ) / (1 − 4f²τ²).
struct HammerDesign {
  std::vector<Eigen::Index> points;  ///< chosen candidates, the most useful first
  Eigen::Index hits = 3;             ///< at each of them
  double pulse_s = 0.0, peak_n = 0.0;
  double fall_db = 0.0;  ///< of the spectrum from 0 Hz to the end of the band
  Eigen::Index samples = 0;
  double record_s = 0.0;
  double exponential_s = 0.0;  ///< time constant of the window; 0: none is needed
  double force_window_s = 0.0;
  double duration_s = 0.0;
  std::vector<ExpectedMode> modes;           ///< `drive`: at the best of the chosen points
  std::vector<ExpectedCoherence> coherence;  ///< of one blow; `input`: of `points`
  std::vector<std::string> notes;
};

/// The fewest blows in all that give every mode in the band the wanted deviations, with three at a
/// point or more. Points are added greedily and exchanged while that lowers the number.
/// @param model       kinds of its first p outputs; inputs are not used
/// @param candidates  n×m [kg^-1/2]: the modes along the blow at each point that can be hit
/// @throws InvalidInput  as experiment_design(); no candidate; no line of a record in the band
/// Cost: modes·candidates per chosen point, and one fit.
[[nodiscard]] HammerDesign hammer_design(const DesignModel& model,
                                         const Eigen::MatrixXd& candidates, const HammerPlan& plan);

}  // namespace chladni::identification
