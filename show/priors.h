// Learned hyper-parameters as text and JSON.
#pragma once

#include "show/run.h"
#include "steps/priors.h"

namespace chladni::app {

[[nodiscard]] io::JsonObject priors_json(const Solution& solution, const LearnedPriors& result);

[[nodiscard]] std::string priors_table(const Solution& solution, const LearnedPriors& result);

}  // namespace chladni::app
