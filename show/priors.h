// Learned hyper-parameters as text and JSON.
#pragma once

#include "show/run.h"
#include "steps/priors.h"

namespace chladni::show {

[[nodiscard]] io::JsonObject priors_json(const stage::Solution& solution,
                                         const steps::LearnedPriors& result);

[[nodiscard]] std::string priors_table(const stage::Solution& solution,
                                       const steps::LearnedPriors& result);

}  // namespace chladni::show
