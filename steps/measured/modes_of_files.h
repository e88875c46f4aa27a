// Modes as the files of each kind have them.
#pragma once

#include "diagnosis/measured_modes.h"
#include "io/shape_table.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

/// Modes with their frequencies in the order of the file, at channels of the study. Shapes that
/// state no deviation have 0.
/// @throws InvalidInput  as measured_modes
[[nodiscard]] diagnosis::MeasuredModes modes_of_table(const study::Study& study, stage::Work& work);
[[nodiscard]] diagnosis::MeasuredModes modes_of_uff(const study::Study& study, stage::Work& work);
[[nodiscard]] diagnosis::MeasuredModes modes_of_identified(const study::Study& study);

/// Warns of values without a deviation at channels that have others: a program may have left the
/// deviation out because it does not know the value, which is no measurement then.
void warn_of_unstated(const io::ShapeTable& table, const std::string& file, stage::Work& work);

}  // namespace chladni::steps
