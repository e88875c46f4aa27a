#include "simulators/plate_study.h"

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {

priors::Places plate_places(const PlateModes& modes, const Eigen::MatrixX2d& places) {
  priors::Places seen;
  seen.position = Points::Zero(places.rows(), 3);
  seen.position.leftCols<2>() = places;
  seen.direction = Points::Zero(places.rows(), 3);
  seen.direction.col(2).setOnes();
  seen.shapes = shapes_at(modes, places);
  return seen;
}

priors::Simulation plate_simulation(const PlateModes& believed, const PlateSurface& surface) {
  priors::Simulation simulation;
  simulation.frequency_hz = believed.frequency_hz;
  simulation.surface = plate_places(believed, surface.places);
  simulation.area = surface.area;
  return simulation;
}

Eigen::VectorXd unit_rms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area) {
  const Eigen::VectorXd square = shapes.array().square().matrix().transpose() * area / area.sum();
  return square.cwiseSqrt().cwiseInverse();
}

PlateTest plate_test(const PlateModes& truth, const PlateModes& believed,
                     const PlateSurface& surface, const Eigen::MatrixX2d& places, int count,
                     double noise, unsigned seed) {
  require(truth.mode_count() >= 3 + count, "plate: the truth has too few modes");
  const Eigen::MatrixXd shapes = shapes_at(truth, surface.places).middleCols(3, count);
  const Eigen::VectorXd scale = unit_rms(shapes, surface.area);
  PlateTest test;
  test.truth = shapes * scale.asDiagonal();
  test.measured.places = plate_places(believed, places);
  test.measured.frequency_hz = truth.frequency_hz.segment(3, count);
  test.measured.noise = Eigen::MatrixXd::Constant(places.rows(), count, noise);
  test.measured.values = shapes_at(truth, places).middleCols(3, count) * scale.asDiagonal() +
                         noise * Dice(seed).normal(places.rows(), count);
  return test;
}

}  // namespace chladni::simulators
