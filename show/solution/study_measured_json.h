// Parts of study.json: measurement, experiment and identification.
#pragma once

#include "io/json.h"
#include "study/study.h"

namespace chladni::show {

[[nodiscard]] io::Json measurement_json(const study::MeasurementPlan& plan);
[[nodiscard]] io::Json experiment_json(const study::ExperimentPlan& plan);
[[nodiscard]] io::Json identification_json(const study::IdentificationPlan& plan);

}  // namespace chladni::show
