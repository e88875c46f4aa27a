// A study's simulation in the form that a diagnosis uses.
#pragma once

#include <cmath>

#include "diagnosis/structure.h"
#include "stage/solution.h"

namespace chladni::stage {

/// Flexible modes for a diagnosis.
inline constexpr int kDiagnosisModes = 64;

/// The study with the modes for a diagnosis: kDiagnosisModes, or the number it asks for, if that
/// is larger. `structure_of` uses those that the band needs.
[[nodiscard]] study::Study with_modes_for_diagnosis(study::Study study);

/// The solution's modes up to three times `high_hz` (at least the 12 lowest flexible ones; no
/// repeated mode is cut; infinite: all), with the static flexibility of the others at the channels.
/// The modes include what the study attaches to its body; Structure::springs and masses contain its
/// stiffness and mass, and Structure::grown what these are on a larger body. The mesh error of each
/// frequency is the solution's estimate.
///
/// The faces are those of `[diagnosis] on` (stage/diagnosis_faces.h). For a plate it
/// is the top, with u = x and v = y of the body's own frame. The uppermost face counts. Slopes are
/// differences over short steps on the surface (their mean at the borders of elements). A body more
/// than eight times as long as wide is scanned along its middle line and divided along its length
/// only. Thickness is the extent of the body along the chart's normal. If it is less than an eighth
/// of both sides, the body bends (bending_power 3) and has orthotropy: plane-stress constants.
///
/// `surface.at` owns its data and may be called from several threads at once; some 20 µs.
/// Cost: one factorisation, and per element some r² times its nodes.
/// A study without channels has a structure without channels: enough for frequencies alone.
/// @throws InvalidInput  as fem::reduced
[[nodiscard]] diagnosis::Structure structure_of(const study::Study& study, const Solution& solution,
                                                double high_hz = HUGE_VAL);

}  // namespace chladni::stage
