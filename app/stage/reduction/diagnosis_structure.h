// A study's simulation as the diagnosis sees it.
#pragma once

#include <cmath>

#include "app/stage/solution.h"
#include "diagnosis/structure.h"

namespace chladni::app {

/// The study with the modes that a diagnosis works on: 64 flexible ones, or as many as it asks for
/// itself where that is more. Of its solution `structure_of` takes what the band needs.
[[nodiscard]] Study with_modes_for_diagnosis(Study study);

/// The solution's modes up to three times `high_hz` (the 12 lowest flexible ones at least, no
/// repeated one cut; infinite: all), with what the others leave statically at the channels. What
/// the study attaches to its body is in them; Structure::springs and masses say how much of their
/// stiffness and mass that is. What the mesh leaves of each frequency is the solution's estimate.
///
/// The faces are those of `[diagnosis] on` (app/stage/reduction/diagnosis_faces.h): for a plate its top, u = x and
/// v = y of the body's own frame. Where several things lie above each other the uppermost counts.
/// Slopes are differences over short steps on the
/// surface (their mean at the borders of elements). A body that is more than eight times as long as
/// wide is scanned along its middle line and divided along its length only. Thickness is the extent
/// of the body along the chart's normal; it counts (bending_power 3) where it is less than an
/// eighth of both sides, and so does orthotropy: plane-stress constants.
///
/// `surface.at` owns what it needs and may be called from several threads at once; some 20 µs.
/// Cost: one assembly, one factorisation, and per element some r² times its nodes.
/// @throws InvalidInput  no sensor or no actuator; as fem::reduced
[[nodiscard]] diagnosis::Structure structure_of(const Study& study, const Solution& solution,
                                                double high_hz = HUGE_VAL);

}  // namespace chladni::app
