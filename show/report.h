// The report page with the results of a study.
#pragma once

#include "show/run.h"
#include "steps/diagnosis.h"
#include "steps/interpolation.h"
#include "steps/placement.h"

namespace chladni::app {

/// Results of a study in addition to the modes; null if a step was not made.
struct Found {
  const Placed* placement = nullptr;
  const Interpolated* shapes = nullptr;
  const Diagnosed* diagnosis = nullptr;
};

/// report.html: the modes with a viewer, places for devices, the interpolated shapes, the body, the
/// channels, the origin of all results. It shows the pictures that exist.
void leave_report(const Study& study, const Solution& solution, const Found& found, Run& run);

}  // namespace chladni::app
