// What the Kalman filter of a layout will know of a region's motion, and what a loop makes of it.
#include <cmath>

#include "placement/layout.h"
#include "placement/layout_criteria/undefined.h"

namespace chladni::placement {
namespace {

double error(const LayoutView& view) {
  if (!view.observer || view.sensors_all.rows() == 0) return kUndefined;
  return std::sqrt(view.observer->estimate);
}

double cost(const LayoutView& view) {
  if (!view.observer || view.sensors_all.rows() == 0) return kUndefined;
  return std::sqrt(view.observer->loop);
}

}  // namespace

extern const LayoutCriterion observer_error, loop_cost;
constinit const LayoutCriterion observer_error{"observer_error",
                                               "rms over the region of what a Kalman filter on the "
                                               "layout's sensors does not know of its motion "
                                               "under the stated disturbances, in steady state",
                                               "Riccati equation; thesis, chapter 7",
                                               "m",
                                               false,
                                               error};
constinit const LayoutCriterion loop_cost{"loop_cost",
                                          "root of the mean square motion of the region and of "
                                          "effort times force in the best loop on that "
                                          "filter (LQG)",
                                          "two Riccati equations; thesis, chapter 7",
                                          "m",
                                          false,
                                          cost};

}  // namespace chladni::placement
