// What was measured beside the simulation, as text, JSON and pictures.
#pragma once

#include "io/result_table.h"
#include "show/run.h"
#include "steps/compared.h"

namespace chladni::show {

/// Measured modes of a file beside the simulated ones.
[[nodiscard]] io::ResultTable modes_beside_table(const std::vector<diagnosis::ModeTold>& modes);

/// Modes side by side; of responses also the errors of each, by band and by channel.
/// @param all  false: the error of each response only where there are few
[[nodiscard]] std::string compared_text(const steps::StudyComparison& comparison, bool all);

/// comparison.json
[[nodiscard]] io::JsonObject compared_json(const steps::StudyComparison& comparison);

/// comparison.json; of responses also responses.png with responses_curves.json, errors.png, mac.png
void leave_compared(const steps::StudyComparison& comparison, Run& run);

}  // namespace chladni::show
