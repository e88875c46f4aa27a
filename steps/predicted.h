// Limits of responses that are predicted from a field of shapes.
#pragma once

#include <string>
#include <vector>

#include "steps/interpolation.h"

namespace chladni::steps {

/// The model from which the shapes were identified. @throws InvalidInput  there is none
[[nodiscard]] const IdentifiedModel& identified_of(const Interpolated& result);

/// Missing parts of the predicted responses and their band, a sentence each: modes without a scale,
/// the 1/s² term of modes at 0 Hz, of all places or of those that do not move along z, the modes
/// above the band. @throws InvalidInput  as identified_of
[[nodiscard]] std::vector<std::string> left_out_of_predictions(const Interpolated& result);

/// The sentence about those of such places that do not move along z; empty if there are none, or no
/// modes at 0 Hz. @throws InvalidInput  as identified_of
[[nodiscard]] std::string left_out_across_z(const Interpolated& result,
                                            const std::vector<std::string>& names,
                                            const Points& directions);

/// The way of that name; empty: the first.
/// @throws InvalidInput  the study was not interpolated by it
[[nodiscard]] const Interpolation& interpolation_called(const Interpolated& result,
                                                        const std::string& name);

/// G(ρ) from all actuators at places, with its deviation.
/// @param places  with the simulation's modes along the direction of motion (places_at)
/// @throws InvalidInput  as identified_of; a frequency of 0 beside modes at 0 Hz
[[nodiscard]] identification::PredictedResponses responses_at(const Interpolated& result,
                                                              const Interpolation& interpolation,
                                                              const priors::Places& places,
                                                              const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::steps
