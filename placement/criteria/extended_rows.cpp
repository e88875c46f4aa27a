#include <cmath>

#include "placement/criteria.h"
#include "placement/criteria/for_people.h"

namespace chladni::placement {
namespace {

// Mean square of the group's shapes at the actuators, and the variance of their noise.
struct AtActuators {
  double signal, noise;
};

AtActuators at_actuators(const PairView& view, Eigen::Index g) {
  const auto [first, size] = view.groups[static_cast<std::size_t>(g)];
  const auto modes = static_cast<double>(size);
  const double noise = view.actuator_noise.segment(first, size).squaredNorm() / modes;
  if (view.actuators.rows() == 0) return {view.rms(g) * view.rms(g), noise};
  const double entries = modes * static_cast<double>(view.actuators.rows());
  return {view.actuators.middleCols(first, size).squaredNorm() / entries, noise};
}

Eigen::MatrixXd extended_rows_score(const PairView& view) {
  Eigen::MatrixXd error = alpha_deviation(view);
  for (Eigen::Index g = 0; g < error.cols(); ++g) {
    const auto [signal, noise] = at_actuators(view, g);
    const double own = noise / std::max(signal, 1e-12 * view.rms(g) * view.rms(g));
    // β = α² scales rows from actuators relative to rows from sensors.
    error.col(g) = (4.0 * error.col(g).array().square() + own).sqrt().matrix();
  }
  return error.cwiseInverse();
}

}  // namespace

extern const Criterion extended_rows;
constinit const Criterion extended_rows{
    .name = "extended_rows",
    .summary =
        "relative error of the rows by which actuators extend the output matrix: of the gain "
        "that scales them, and their own; of the worst mode",
    .source = "(5.2) to (5.5), first order",
    .unit = "%",
    .score = extended_rows_score,
    .for_people = deviation_percent,
};

}  // namespace chladni::placement
