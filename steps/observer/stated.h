// What [observer] of a study states, in the words of the rooms that compute.
#pragma once

#include <string>

#include "mesh/site.h"
#include "modal/kalman_filter.h"
#include "study/study.h"

namespace chladni::steps {

/// The place of the study on the body. @param what  "point \"exposed\"", for messages
/// @param reach  `stage::reach_of` the body
/// @throws InvalidInput  it lies farther off the body
[[nodiscard]] mesh::Site site_of(const study::Study& study, const mesh::SiteFinder& finder,
                                 double reach, const study::Place& at, const std::string& what);

/// @param input  of the model, at which it acts
[[nodiscard]] modal::Disturbance disturbance_of(const study::DisturbancePlan& plan,
                                                const std::string& name, Eigen::Index input);

/// The rate of [observer], [state_space] or [experiment], the first that is stated; 0: none is.
[[nodiscard]] double stated_sample_rate(const study::Study& study);

/// [s] of each record in which the filter settles: `settle` of the study, or five time constants of
/// the filter's slowest pole; infinity where that pole is at 1.
[[nodiscard]] double settling_time(const study::ObserverPlan& plan,
                                   const modal::KalmanFilter& filter, double sample_time_s);

/// The first sample after that, more than any record has where it never ends.
[[nodiscard]] Eigen::Index first_settled(double settle_s, double sample_time_s);

/// Why no record may be used.
[[nodiscard]] std::string nothing_settles(const std::string& file, double settle_s);

}  // namespace chladni::steps
