// Words that the text and the files of a designed experiment share.
#pragma once

#include <string>
#include <vector>

#include "steps/designed.h"

namespace chladni::show {

/// "y1/u1", or "y1/point 2".
[[nodiscard]] std::string response_words(const study::Study& study,
                                         const steps::DesignedExperiment& designed,
                                         const identification::ExpectedCoherence& response);

/// What bounds the force of an actuator: "stroke", "voltage" or "force".
[[nodiscard]] std::string limit_word(const study::Study& study, const identification::Force& force);

/// What must be known beside the tables.
[[nodiscard]] std::vector<std::string> notes_of(const steps::DesignedExperiment& designed);

}  // namespace chladni::show
