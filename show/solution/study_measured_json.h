// Parts of study.json: measurement, experiment and identification.
#pragma once

#include "io/json.h"
#include "study/study.h"

namespace chladni::app {

[[nodiscard]] io::Json measurement_json(const MeasurementPlan& plan);
[[nodiscard]] io::Json experiment_json(const ExperimentPlan& plan);
[[nodiscard]] io::Json identification_json(const IdentificationPlan& plan);

}  // namespace chladni::app
