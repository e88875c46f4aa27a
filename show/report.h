// The report page with the results of a study.
#pragma once

#include <string>

#include "show/run.h"
#include "steps/diagnosis.h"
#include "steps/interpolation.h"
#include "steps/placement.h"

namespace chladni::show {

/// Results of a study in addition to the modes; null if a step was not made.
struct Found {
  const steps::BestPlaces* placement = nullptr;
  const steps::Interpolated* shapes = nullptr;
  const steps::Diagnosed* diagnosis = nullptr;
};

/// Modes with the viewer, as a page of their own.
[[nodiscard]] std::string modes_page(const study::Study& study, const stage::Solution& solution);

/// The verdict with what it rests on, and the modes with the viewer that shows its places.
[[nodiscard]] std::string diagnosis_page(const study::Study& study,
                                         const steps::Diagnosed& diagnosis);

/// report.html: the verdict and what it rests on, places for devices, the identified model, the
/// interpolated shapes, the modes with a viewer, the body, the channels, the origin of all results.
/// It shows the pictures that exist; that of the modes only if the page stays below 1 MB.
void leave_report(const study::Study& study, const stage::Solution& solution, const Found& found,
                  Run& run);

}  // namespace chladni::show
