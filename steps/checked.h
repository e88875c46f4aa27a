// What can be said of a study before it is solved.
#pragma once

#include "stage/solution.h"

namespace chladni::steps {

/// Reads geometry, places and materials, and forecasts the cost: from the mesh where that is made
/// within seconds.
/// @param data  also looks for the files of data that the study names; a note tells of those that
///              `simulate` will write
/// @throws InvalidInput  as its parts; files that do not exist, all at once
[[nodiscard]] stage::Introduction checked(const study::Study& study, bool data, stage::Work& work);

/// @throws InvalidInput  the study names no measured shapes or responses, or their file does not
///                       exist: before minutes of solving
void require_measured(const study::Study& study);

}  // namespace chladni::steps
