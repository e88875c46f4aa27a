// Modes as the files of each kind have them.
#pragma once

#include "diagnosis/measured_modes.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

/// Modes with their frequencies in the order of the file, at channels of the study. Shapes that
/// state no deviation have 0.
/// @throws InvalidInput  as measured_modes
[[nodiscard]] diagnosis::MeasuredModes modes_of_table(const study::Study& study, stage::Work& work);
[[nodiscard]] diagnosis::MeasuredModes modes_of_uff(const study::Study& study, stage::Work& work);
[[nodiscard]] diagnosis::MeasuredModes modes_of_identified(const study::Study& study);

}  // namespace chladni::steps
