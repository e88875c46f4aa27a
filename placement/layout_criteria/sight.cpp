// Strength with which sensors see and actuators drive the wanted modes.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>

#include "placement/layout.h"
#include "placement/layout_criteria/undefined.h"

namespace chladni::placement {
namespace {

// Smallest eigenvalue of ΦᵀΦ [1/kg] for one group at some channels. For lightly damped, separate
// modes it equals that of the Gramian up to a factor of the mode.
double least(const Eigen::MatrixXd& shapes, const modal::ModeGroup& group) {
  const Eigen::MatrixXd block = shapes.middleCols(group.first, group.size);
  const Eigen::MatrixXd gram = block.transpose() * block;
  return std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly)
                           .eigenvalues()(0));
}

double weakest(const Eigen::MatrixXd& shapes, const LayoutView& view) {
  if (shapes.rows() == 0) return kUndefined;
  double weakest = std::numeric_limits<double>::infinity();
  for (const auto& group : view.groups) {
    const double average = static_cast<double>(shapes.rows()) * std::pow(view.rms(group.first), 2);
    weakest = std::min(weakest, std::sqrt(least(shapes, group) / average));
  }
  return weakest;
}

double points(const LayoutView& view) { return static_cast<double>(observed(view).rows()); }

double seen(const LayoutView& view) { return weakest(view.sensors, view); }

double driven(const LayoutView& view) { return weakest(view.actuators, view); }

// Smallest Hankel singular value of a mode: half its peak of receptance, over all channels.
double smallest_response(const LayoutView& view) {
  if (view.sensors.rows() == 0 || view.actuators.rows() == 0) return kUndefined;
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& group : view.groups) {
    const double omega = 2.0 * std::numbers::pi * view.frequency_hz(group.first);
    const double damping = view.damping_ratio(group.first);
    if (!(damping > 0.0)) return kUndefined;
    const double shapes = std::sqrt(least(view.sensors, group) * least(view.actuators, group));
    smallest = std::min(smallest, shapes / (4.0 * damping * omega * omega));
  }
  return smallest;
}

}  // namespace

extern const LayoutCriterion observed_points, observability, controllability, response;
constinit const LayoutCriterion observed_points{
    "observed_points",
    "points where shapes are known: sensors and actuators, pairs once",
    "thesis (5.2)",
    "1",
    true,
    points};
constinit const LayoutCriterion observability{
    "observability",
    "how strongly the sensors see the weakest mode, over what places of average motion would",
    "observability Gramian (Gawronski 2004, 4.2)",
    "1",
    true,
    seen};
constinit const LayoutCriterion controllability{
    "controllability",
    "how strongly the actuators drive the weakest mode, over what places of average motion would",
    "controllability Gramian (Gawronski 2004, 4.2)",
    "1",
    true,
    driven};
constinit const LayoutCriterion response{
    "response",
    "smallest Hankel singular value of a mode; needs a damping ratio",
    "Gawronski 2004, 4.3",
    "m/N",
    true,
    smallest_response};

}  // namespace chladni::placement
