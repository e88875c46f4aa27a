// Learned hyper-parameters as text and JSON.
#pragma once

#include "app/show/run.h"
#include "app/steps/priors.h"

namespace chladni::app {

[[nodiscard]] io::JsonObject priors_json(const Solution& solution, const LearnedPriors& result);

[[nodiscard]] std::string priors_table(const Solution& solution, const LearnedPriors& result);

}  // namespace chladni::app
