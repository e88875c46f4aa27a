// The page that shows what a study found.
#pragma once

#include "app/interpolation.h"
#include "app/steps/diagnosis.h"
#include "app/steps/placement/placement.h"

namespace chladni::app {

/// What a study found beside the modes; null where a step was not taken.
struct Found {
  const Placed* placement = nullptr;
  const Interpolated* shapes = nullptr;
  const Diagnosed* diagnosis = nullptr;
};

/// report.html: the modes with a viewer, where devices belong, the interpolated shapes, the body,
/// the channels, where it all comes from. Shows the pictures that are there.
void leave_report(const Study& study, const Solution& solution, const Found& found, Run& run);

}  // namespace chladni::app
