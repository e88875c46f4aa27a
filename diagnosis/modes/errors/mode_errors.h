// Measured modes beside the modes of a hypothesis: by what they differ.
#pragma once

#include <vector>

#include "diagnosis/measured_modes.h"
#include "diagnosis/modes/errors/levels.h"
#include "diagnosis/modes/errors/model_errors.h"
#include "diagnosis/modes/matching.h"
#include "diagnosis/modes/partner.h"
#include "diagnosis/modes/recorded_modes.h"

namespace chladni::diagnosis {

/// Numbers that are not believed: those of a mode or of a channel.
struct Disturbed {
  enum class What { nothing, mode, sensor, actuator };
  What what = What::nothing;
  Eigen::Index index = 0;
};

/// Measured less model, number by number, in blocks of one measured mode: ln f; ln ζ; the real and
/// imaginary parts of the shape at sensors, then at actuators, each shape of root mean square 1 and
/// turned to the model's phase; ln of the residue, real and imaginary part, where it is known. A
/// mode that is alone, or is not believed, has errors of 1.
/// @param shares  for each measured mode whether its block has the errors that blocks share. Of
///                another one only its own numbers are made, which costs far less where no block
///                has them: the changes of all modes by errors of the body are left out then.
[[nodiscard]] ModeErrors mode_errors(const Structure& structure, const MeasuredModes& measured,
                                     const RecordedModes& model, const ShapeUnits& units,
                                     const Matching& matching, const std::vector<BodyError>& body,
                                     const Eigen::MatrixXd& smooth, const Disturbed& disturbed,
                                     const std::vector<bool>& shares);

}  // namespace chladni::diagnosis
