// The virtual laboratory of a study: its bench and its results.
#pragma once

#include "recordings/frf_estimate.h"
#include "recordings/virtual_experiment.h"
#include "stage/solution.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

/// The recordings that `simulate` leaves among its results.
inline constexpr const char* kRecordingsFile = "time_data.csv";

struct Bench {
  recordings::VirtualRig rig;
  recordings::VirtualExperimentPlan plan;
  recordings::TimeData excitation;  ///< of a file, one period each; no records: drawn anew
  std::vector<std::string> notes;   ///< assumptions that were made
  Eigen::Index modes = 0;           ///< in the structure; 0: the chain, which has all its poles
};

/// @throws InvalidInput  no sensor or actuator, a free body without a loop, a chain that is not the
///                       thesis' beam, an impossible loop, a spring that follows no displacement
[[nodiscard]] Bench bench_of(const study::Study& study, stage::Work& work);

struct Simulated {
  recordings::FrfEstimate estimate;  ///< compensated as the study asks
  recordings::TimeData recordings;   ///< if the study asks for them
  double crest_factor = 0.0;
  double phase_delay_s = 0.0, phase_delay_std_s = 0.0;  ///< seen in the phases, before compensation
};

/// Responses of the simulation without noise, from the study's actuators to its sensors, each in
/// its quantity and as its channel records it. Cost: that of stage::at_channels.
/// @throws InvalidInput  no sensor or no actuator; as modal::frf
[[nodiscard]] modal::FrfSet simulated_responses(const study::Study& study,
                                                const stage::Solution& solution,
                                                const Eigen::VectorXd& frequency_hz);

[[nodiscard]] Simulated simulated(const study::Study& study, const Bench& bench, stage::Work& work);

}  // namespace chladni::steps
