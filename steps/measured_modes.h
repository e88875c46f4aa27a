// Measured modes of a study's file, on its channels.
#pragma once

#include <optional>

#include "diagnosis/measured_modes.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

/// True if `[measurement] modes` names a file.
[[nodiscard]] bool has_modes(const study::MeasurementPlan& plan);

/// The modes in `[measurement] modes`, within the band of the diagnosis, without the channels that
/// are held out. By the ending of the file: a table (io/shape_table.h), a universal file
/// (io/node_shapes.h), or the identified.json of `chladni identify`. Values are motions of the body
/// along the channels' directions. In a universal file a channel is found by its node, or by a name
/// such as "101z". Modes at 0 Hz are left out. A shape value without a deviation has the study's
/// `noise`, relative to the root mean square of the mode's values on its side.
/// @throws InvalidInput  no file is named; there is no such file; its kind is not known; no mode is
///                       left; shapes at no channel of the study. The message names the file
[[nodiscard]] diagnosis::MeasuredModes measured_modes(const study::Study& study, stage::Work& work);

/// The modes in `[measurement] reference`, read likewise; none if it names no file.
/// @throws InvalidInput  as measured_modes; no channel or no mode in common with `later`
[[nodiscard]] std::optional<diagnosis::MeasuredModes> reference_modes(
    const study::Study& study, const diagnosis::MeasuredModes& later, stage::Work& work);

/// The modes up to `highest_hz`, where the modes of the simulation end. A note tells of others.
/// @throws InvalidInput  there is none
[[nodiscard]] diagnosis::MeasuredModes modes_below(double highest_hz,
                                                   const diagnosis::MeasuredModes& all,
                                                   const study::Study& study, stage::Work& work);

}  // namespace chladni::steps
