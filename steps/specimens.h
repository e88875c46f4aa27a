// Diagnosis of several specimens of one design, each a study with its measurement.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/specimens.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

struct DiagnosedSpecimens {
  std::vector<study::Study> studies;  ///< one of each specimen
  std::vector<diagnosis::Specimen> specimens;
  diagnosis::SpecimensDiagnosis result;
};

/// Reads all studies and all their measurements, then solves each, and diagnoses them together. The
/// modes of a measurement are those of its file, or are identified from its responses within the
/// band.
/// @throws InvalidInput  a study without a measurement, or without a constant that states how well
///                       it is known; as diagnosis::diagnosed. The message names the specimen
[[nodiscard]] DiagnosedSpecimens diagnosed_specimens(const study::Study& study, stage::Work& work);

}  // namespace chladni::steps
