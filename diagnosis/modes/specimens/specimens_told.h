// What a diagnosis of several specimens says.
#pragma once

#include <vector>

#include "diagnosis/modes/specimens/hypotheses.h"
#include "diagnosis/modes/specimens/linearised.h"

namespace chladni::diagnosis {

/// The answer. @param strays  numbers of the series that are not believed
[[nodiscard]] SpecimensDiagnosis told(const std::vector<Specimen>& specimens,
                                      const SpecimenModels& models, const Series& series,
                                      const JointModel& model, const WeighedFits& weighed,
                                      const std::vector<Eigen::Index>& strays,
                                      const DiagnosisOptions& options);

}  // namespace chladni::diagnosis
