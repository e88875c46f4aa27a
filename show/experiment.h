// The designed experiment as text, JSON, signals and a picture.
#pragma once

#include <string>

#include "show/run.h"
#include "steps/designed.h"

namespace chladni::show {

/// What the experiment gives, and what it does not, in one sentence.
[[nodiscard]] std::string experiment_verdict(const study::Study& study,
                                             const steps::DesignedExperiment& designed);

/// The verdict, how to measure, and what to expect of each mode and response.
[[nodiscard]] std::string experiment_text(const study::Study& study,
                                          const steps::DesignedExperiment& designed);

/// experiment.json
[[nodiscard]] io::JsonObject experiment_json(const study::Study& study,
                                             const steps::DesignedExperiment& designed);

/// experiment.json, experiment.png, and the signals: excitation.csv, excitation.mat,
/// excitation_r1_e1.wav, ...; with a hammer hammer_points.csv.
void leave_experiment(const study::Study& study, const steps::DesignedExperiment& designed,
                      Run& run);

}  // namespace chladni::show
